"""The quiz on bags; two of its questions are about a bag that is drawn anew each time."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong
from labkit.lessons.bags.made import TRIP_TOPICS, silent_topic, stop_sec, trip_is_missing

__all__ = ['QUIZ', 'WARM_UP']


def _explain_silent(word: str) -> str:
    missing = trip_is_missing()
    if missing:
        return missing
    if f'/{word.strip("/")}' in TRIP_TOPICS:
        return 'Its messages go on to the end of the strip. Which strip ends before the others?'
    return ''


WARM_UP = Quiz(
    'warm_up',
    Choice(
        'A scanner publishes best effort. What should your subscription ask for?',
        right('best effort', 'It must not ask for more than is offered.'),
        wrong('reliable', 'That is more than is offered: the two do not match.'),
        wrong('transient local', 'That is durability. The scanner keeps nothing for later.'),
    ),
    Choice(
        '`Turtlebot(lockstep=0.1)` gets no command for ten seconds. How far does its time go?',
        right('not at all', 'Its time goes by commands, 0.1 s for each one.'),
        wrong('by ten seconds', 'So does the clock of this machine, which it does not follow.'),
        wrong('by 0.1 s', 'That is how far one command takes it.'),
    ),
    Choice(
        '`use_sim_time` of a running node is to be changed. Who can do that?',
        right('any node, and the command line', 'By ros2 param set, if the node allows it.'),
        wrong('the node itself alone', 'Its services let others set its parameters.'),
        wrong('nobody, before it is started again', 'Parameters can change while a node runs.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'bags',
    Choice(
        'What does a bag hold?',
        right(
            'Messages, each with its topic and the time at which it came.',
            'So they can be published again, in the same order and with the same pauses.',
        ),
        wrong(
            'The nodes, with their code.',
            'Nothing of a node is in a bag. It holds what nodes have published.',
        ),
        wrong(
            'A film of the robot.',
            'Only if a camera publishes pictures on a topic that is recorded.',
        ),
    ),
    Choice(
        'You record /scan, and no node publishes on /scan meanwhile. What is in the bag?',
        right('No topic at all.', 'A bag knows only the topics that it has heard of.'),
        wrong('Empty scans.', 'Nobody makes up messages: no message comes, none is recorded.'),
        wrong(
            'Nothing, since the recording is refused.',
            'It is not refused: the topic may come later, and is recorded then.',
        ),
    ),
    Choice(
        'lab.play(..., rate=2.0) plays a bag of 10 s. How long does it take?',
        right('5 s', 'Twice as fast: every pause is half as long.'),
        wrong('20 s', 'A rate of 0.5 would take 20 s.'),
        wrong('10 s', 'That would be a rate of 1.0.'),
    ),
    Several(
        'A bag holds /odom and /cmd_vel. A robot is listening on /cmd_vel. How can you keep it '
        'from driving while the bag plays?',
        right(
            "Play with remap={'/cmd_vel': '/old/cmd_vel'}.",
            'The commands go where no robot listens.',
        ),
        right('Play /odom alone.', 'What is not played is not heard.'),
        wrong(
            'Play with a smaller rate.',
            'The robot would get the same commands, more slowly.',
        ),
        wrong('Nothing: a robot knows that a bag plays.', 'It cannot know. It drives.'),
    ),
    Choice(
        'A node has use_sim_time, and a bag plays with clock=100. What time does the node have?',
        right(
            'That of the bag: the time of the recording.',
            'The player says on /clock which time of the bag it is.',
        ),
        wrong('That of this machine.', 'So it is without use_sim_time.'),
        wrong(
            '0, until the bag is at its end.',
            'It is 0 only until the first message on /clock comes.',
        ),
    ),
    Choice(
        'A recording was killed before its end. What is lost?',
        right(
            'metadata.yaml, and maybe the last moment.',
            'What was written before can be read. rosbag2 keeps more in memory, so it loses more. '
            '`ros2 bag reindex` writes metadata.yaml anew.',
        ),
        wrong('All of it.', 'The messages are written while they come, many times a minute.'),
        wrong('Nothing.', 'metadata.yaml is written at the end, so it is missing.'),
    ),
    Word(
        "Look at lab.bag('bags/trip'). Which topic falls silent before the others?",
        silent_topic,
        'Its strip ends some seconds before the end of the bag.',
        'Look at the strips: where does the last line of each one stand?',
        explain=_explain_silent,
    ),
    Number(
        'And at which second of bags/trip does the robot run into the wall, and stop?',
        stop_sec,
        'From there on x stays the same, and the speed in its odometry is 0.',
        'Plot /odom.pose.pose.position.x, and move the slider to where the line bends.',
        explain=trip_is_missing,
        tolerance=0.05,
        unit='s',
    ),
)
