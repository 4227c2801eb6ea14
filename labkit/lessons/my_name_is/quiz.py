"""The quiz on chains of nodes."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, right, wrong

__all__ = ['QUIZ']


def _listeners_of_incomplete() -> int:
    """Count the subscriptions to /incomplete at this moment."""
    from labkit.background.discovery import asking_node

    return asking_node().count_subscribers('/incomplete')


def _nobody_listens(number: float) -> str:
    """Say which cell makes a listener, if there is none."""
    if _listeners_of_incomplete():
        return ''
    return 'At this moment it has none. Run the cell with your StageTwo, and ask the graph again.'


QUIZ = Quiz(
    'my_name_is',
    Choice(
        'Stage two is started before stage one. What happens?',
        right(
            'It waits. When stage one speaks, it hears that.',
            'A subscription needs no publisher. Whoever comes later is found.',
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
            'One node may publish on a topic and subscribe to it. Mostly that is a mistake.',
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
            50: 'That is 10 divided by 0.2. A stage can not publish more than it gets.',
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
