"""The quiz on talker and listener."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, right, wrong

__all__ = ['QUIZ', 'WARM_UP']

WARM_UP = Quiz(
    'warm_up',
    Choice(
        'In a picture of the graph an arrow leads from a node to a topic. What does the node do '
        'there?',
        right('It publishes.', 'Arrows show which way messages go: here to the topic.'),
        wrong('It subscribes.', 'Then the arrow leads the other way, from the topic to the node.'),
        wrong('It waits for an answer.', 'A topic gives no answers. That is what services do.'),
    ),
    Choice(
        'Which of these is the type of a message?',
        right('std_msgs/msg/String', 'It names the package, the word msg, and the type.'),
        wrong('/sight', 'That is a topic. The messages on it are of the type String.'),
        wrong('brain', 'That is the name of a node.'),
    ),
    Choice(
        'Two eyes publish on `/sight`. How does the brain know which of them sent a message?',
        right('It does not know.', 'Neither side of a topic knows the other.'),
        wrong('By the topic', 'Both eyes publish on the same one.'),
        wrong('ROS puts the name into it.', 'A message holds the fields of its type.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'talker_listener',
    Choice(
        "What is create_publisher(String, 'chatter', 10) for?",
        right(
            'It announces that this node will send String messages to the topic /chatter.',
            'It sends nothing yet: publish() does.',
        ),
        wrong(
            'It sends ten messages to /chatter.',
            'It sends none. The 10 is the depth of the queue, not a number of messages to send.',
        ),
        wrong(
            'It makes a node that is called chatter.',
            'The name of a node is given in super().__init__(). This is the name of a topic.',
        ),
    ),
    Choice(
        'Who calls on_timer, the callback of the timer?',
        right(
            'ROS does, each time the period is over, while the node is spun.',
            'You pass the function once. While the node is spun, it is called again and again.',
        ),
        wrong(
            'create_timer() does, at once.',
            'create_timer() only notes the function and the period. That is why no brackets '
            'follow its name.',
        ),
        wrong(
            'The listener does, when it wants a message.',
            'The listener does not know the talker. It waits for what comes on the topic.',
        ),
    ),
    Choice(
        'A subscriber exists, but nobody spins its node. What happens to a message for it?',
        right(
            'It waits in the queue until the node is spun, or until newer ones push it out.',
            'Spinning means: take messages out of the queue and call the callback for each.',
        ),
        wrong(
            'The callback is called all the same.',
            'Somebody has to call it. In a script that is rclpy.spin, here it is lab.spin.',
        ),
        wrong(
            'The publisher keeps it and tries again later.',
            'The publisher is done with it. The message is in the queue of the subscriber.',
        ),
    ),
    Several(
        'The period of the talker is changed from 0.5 to 2.0. What changes?',
        right('A message comes every 2 seconds.', 'The period is the time between two calls.'),
        right('The rate falls from 2 Hz to 0.5 Hz.', 'The rate is 1 divided by the period.'),
        wrong(
            'Two messages come every second.',
            'That was so before, with 0.5. The number is a period in seconds, not a rate.',
        ),
        wrong(
            'The listener has to be changed too.',
            'It is called when a message comes, however often that is.',
        ),
        wrong('The text skips numbers.', 'The count grows by 1 with each call, slow or fast.'),
    ),
    Number(
        'A timer publishes four times a second. How many messages does it send in 10 seconds?',
        40,
        'Four a second, for ten seconds: 4 times 10.',
        'Four messages in each second, and there are ten seconds.',
        wrong={
            2.5: 'You divided. Four in each of ten seconds: multiply.',
            0.25: 'That is the period in seconds: the time between two messages.',
            4: 'That is how many come in one second.',
        },
    ),
    Choice(
        'A new process makes a publisher and publishes at once. Does a subscriber in another '
        'process hear it?',
        right(
            'Usually not: the two have not found each other yet.',
            'Discovery takes time. Wait until the publisher has a subscriber.',
        ),
        wrong(
            'Yes: the topic keeps it.',
            'A topic is a name. By default nobody keeps a message for those who come later.',
        ),
        wrong(
            'Yes, because the depth is 10.',
            'The depth counts for subscribers that are known already.',
        ),
    ),
)
