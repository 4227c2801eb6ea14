"""The quiz on quality of service."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'Why does `Bot` drive more slowly, the nearer it is to its goal?',
        right('Its command is v = -x.', 'A small distance makes a small speed.'),
        wrong('The robot brakes by itself.', 'It drives as it is told, and does not slow down.'),
        wrong('It publishes less often.', 'It takes its steps at 10 Hz from first to last.'),
    ),
    Choice(
        'A message passes a chain of three nodes. What takes most of the time?',
        right('the work in the callbacks', 'One that slept 50 ms made the whole chain slow.'),
        wrong('the way over the topics', 'Measured, it was a small part of a millisecond.'),
        wrong('finding the next node', 'Nodes find each other once, and not for each message.'),
    ),
    Choice(
        'Which command lists each publisher and each subscription of a topic by its node?',
        right('ros2 topic info --verbose', 'It also lists the quality of service of each.'),
        wrong('ros2 topic list -t', 'It lists all topics, with their types.'),
        wrong('ros2 node info', 'It lists what one node has.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'quality_of_service',
    Number(
        'A subscription has depth 5. While its callback is busy, 12 messages come. How many of '
        'them are lost?',
        7,
        'The queue keeps the newest five: 12 - 5 = 7.',
        'The depth says how many messages may wait.',
        wrong={
            5: 'That is how many are heard.',
            0: 'A queue has an end, even a reliable one. What does not fit pushes the oldest out.',
            12: 'The newest five wait in the queue, and are heard.',
        },
    ),
    Choice(
        'A camera sends four times as many pictures as a viewer can show. What does a depth of '
        '100 do for the viewer?',
        right(
            'It shows old pictures: the queue is full, and each one has waited in it.',
            'In the experiment depth 10 was nine pictures behind. A longer queue is further '
            'behind.',
        ),
        wrong(
            'It shows every picture.',
            'The queue fills up all the same, only later. Then pictures are lost, too.',
        ),
        wrong('It works faster.', 'A queue stores messages. It does not make a callback quicker.'),
    ),
    Several(
        'Which pairs match? The publisher is named first.',
        right(
            'reliable, and best effort',
            'More is offered than is asked for. That is enough.',
        ),
        right('best effort, and best effort', 'What is asked for is offered.'),
        wrong(
            'best effort, and reliable',
            'The subscription asks for more than is offered. The sonar and the pilot were such a '
            'pair.',
        ),
        right(
            'transient local, and volatile',
            'They match. The subscription does not ask for what was kept, and does not get it.',
        ),
        wrong(
            'volatile, and transient local',
            'The subscription asks for messages from before, and none are kept.',
        ),
    ),
    Choice(
        'A map is published once, when it is ready. Which durability lets a node that starts '
        'later receive it?',
        right(
            'transient local, at both ends',
            'The publisher keeps the map, and the subscription asks for what was kept.',
        ),
        wrong(
            'transient local at the publisher alone',
            'The two match. But a volatile subscription gets only what comes from now on.',
        ),
        wrong(
            'volatile, and a depth of 100',
            'Depth is how many wait in a queue. A volatile publisher keeps nothing for later.',
        ),
    ),
    Choice(
        'A publisher offers a deadline of 1 s, and stops. Its subscription asks for 1 s, too. '
        'What happens?',
        right(
            'The event callback for the deadline is called, again and again.',
            'The middleware watches the time at both ends.',
        ),
        wrong(
            'The publisher publishes once more.', 'A deadline is watched, and not kept, by ROS.'
        ),
        wrong(
            'The next message is thrown away, since it is late.',
            'That is what a lifespan is for. A late message is heard.',
        ),
    ),
    Choice(
        'A command to drive has waited for ten seconds in a queue, and must not be obeyed any '
        'more. Which policy throws it away?',
        right('lifespan', 'A message that is older is not given to the callback.'),
        wrong('deadline', 'It reports that a message is missing. It throws nothing away.'),
        wrong(
            'best effort',
            'It leaves out repairs of what was lost. What has arrived waits as long as before.',
        ),
    ),
    Choice(
        'A subscription receives nothing, and there is no error. What do you look at first?',
        right(
            'The graph: lab.graph() or lab.doctor(), or ros2 topic info --verbose.',
            'It has both ends and their profiles, and says whether they match.',
        ),
        wrong(
            'The callback: it must be wrong.',
            'It was never called. First see whether the two ends match.',
        ),
        wrong(
            'The network: messages get lost.',
            'Some would arrive. Nothing at all means that two ends do not match, or that a name '
            'is misspelt.',
        ),
    ),
)
