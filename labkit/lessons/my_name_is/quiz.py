"""The quiz on chains of nodes."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, right, wrong

__all__ = ['QUIZ', 'WARM_UP']


def _listeners_of_incomplete() -> int:
    """Count the subscriptions to /incomplete at this moment."""
    from labkit.asking.discovery import asking_node

    return asking_node().count_subscribers('/incomplete')


def _nobody_listens(number: float) -> str:
    """Say which cell makes a listener, if there is none."""
    if _listeners_of_incomplete():
        return ''
    return 'At this moment it has none. Run the cell with your StageTwo, and ask the graph again.'


WARM_UP = Quiz(
    'warm_up',
    Choice(
        '`Driver` of lesson 04 hears numbers on `/speed` and drives the robot. When does it '
        'publish?',
        right('in its callback, once for each number', 'It has no timer: a message sets it off.'),
        wrong('ten times a second', 'That takes a timer, and Driver has none.'),
        wrong('when it is spun for the first time', 'Spinning waits for messages. It sends none.'),
    ),
    Choice(
        '`topic list` shows `/odds`, and nobody has published there yet. Why is it in the list?',
        right('Somebody subscribes to it.', 'A topic exists as soon as either end does.'),
        wrong('ROS comes with that topic.', 'ROS comes with /rosout and /parameter_events.'),
        wrong('It is left from the lesson before.', 'A topic ends with the last node on it.'),
    ),
    Choice(
        'A sensor is faster than your callback, and only its newest value counts. Which depth do '
        'you choose?',
        right('a small one', 'Old values fall out, so the next one is a new one.'),
        wrong('a large one', 'Then the callback works through old values first.'),
        wrong('any: it changes nothing', 'The depth says how many old values wait.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'my_name_is',
    Choice(
        'Stage two is started before stage one. What happens?',
        right(
            'It waits, and hears stage one as soon as that speaks.',
            'A subscription needs no publisher. One that comes later is found.',
        ),
        wrong(
            'It ends with an error, because the topic does not exist.',
            'A topic is a name. It is there as soon as somebody publishes or subscribes.',
        ),
        wrong(
            'It has to be restarted once stage one is there.',
            'ROS goes on looking for partners as long as the node lives.',
        ),
    ),
    Several(
        'Stage one gets a new node name and runs in another process. What does stage two need?',
        right(
            'Nothing, as long as topic and type stay the same.',
            'It knows the topic and the type. It does not know who publishes.',
        ),
        wrong('The new name of the node.', 'It never used the old one either.'),
        wrong('A restart.', 'The new publisher is found while stage two runs.'),
        wrong('The number of the process.', 'Processes find each other by themselves.'),
    ),
    Choice(
        'Stage two publishes on /incomplete, the topic that it subscribes to. What happens?',
        right(
            'It hears its own messages and completes them again and again.',
            'Each message makes another one: it never ends, and the text grows.',
        ),
        wrong(
            'It hears only what others publish.',
            'A subscription takes every message of its topic, also those of its own node.',
        ),
        wrong(
            'ROS refuses it.',
            'One node may publish on a topic and subscribe to it. Usually that is a mistake.',
        ),
    ),
    Number(
        'The callback of stage two takes 0.2 s. Stage one publishes 10 times a second. How many '
        'messages a second leave stage two?',
        5,
        'In one second there is time for 1 / 0.2 = 5 callbacks. The rest waits, or is lost.',
        'How often does a callback of 0.2 s fit into one second?',
        wrong={
            10: 'A callback of 0.2 s fits into one second only five times.',
            2: 'That is 10 times 0.2: the seconds of work that come in each second.',
            50: 'That is 10 divided by 0.2. A stage cannot publish more than it gets.',
        },
        unit='Hz',
    ),
    Number(
        'How many subscriptions does /incomplete have at this moment? Ask the graph.',
        _listeners_of_incomplete,
        'Each node that hears the topic has one.',
        'lab.graph() shows them, and %ros2 topic info /incomplete counts them.',
        explain=_nobody_listens,
    ),
)
