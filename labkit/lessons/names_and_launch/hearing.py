"""Exercise: two robots that do not hear each other."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked
from labkit.lessons.names_and_launch.launch_clauses import Launches, OnlyNodes
from labkit.lessons.names_and_launch.learner_launch import Launched, System

__all__ = ['exercise']

# The robots, and whom each of them is to hear.
PAIRS = {'robot1': 'robot2', 'robot2': 'robot1'}

HEARS_ITSELF = Mistake(
    'hearing/itself',
    'chatter is relative, so each robot has a chatter of its own: its listener hears that one.',
    '<remap from="chatter" to="/{other}/chatter"/>',
    change=[('<remap from="chatter" to="/robot2/chatter"/>', '')],
)
ABSOLUTE_FROM = Mistake(
    'hearing/absolute-from',
    'It hears its own robot: the remap matches nothing. In the namespace {robot} the name chatter '
    'is /{robot}/chatter, and not /chatter.',
    'from="chatter"',
    change=[('from="chatter" to="/robot2', 'from="/chatter" to="/robot2')],
)
RELATIVE_TO = Mistake(
    'hearing/relative-to',
    'A name without / in front is relative: the namespace of the listener is put before it.',
    'to="/{other}/chatter"',
    change=[('to="/robot1/chatter"', 'to="robot1/chatter"')],
)
HEARS_BOTH = Mistake(
    'hearing/both',
    'If all use one topic, everybody hears everybody, and itself.',
    'Remap the listeners only, each to the topic of the other robot.',
    change=[
        ('exec="talker"/>', 'exec="talker"><remap from="chatter" to="/chatter"/></node>'),
        ('to="/robot2/chatter"', 'to="/chatter"'),
        ('to="/robot1/chatter"', 'to="/chatter"'),
    ],
)
HEARS_NOBODY = Mistake(
    'hearing/nobody',
    'Nobody publishes there. Two names that differ in one letter are two topics.',
    'ros2 topic list shows what there is.',
    change=[('to="/robot1/chatter"', 'to="/robot1/chater"')],
)


def _hears_the_other(robot: str) -> Asked[System]:
    """Ask for a listener that hears the talker of the other robot, and that one alone."""
    other = PAIRS[robot]

    def look(system: System) -> None:
        """Raise Fail if it hears another one, or nobody."""
        topics = system.hears.get(f'/{robot}/listener', set())
        heard = {name for name in PAIRS if topics & system.publishes.get(f'/{name}/talker', set())}
        if heard == {other}:
            return
        if heard == {robot}:
            given = [old for old, _ in system.remaps(f'/{robot}/listener')]
            mistake = ABSOLUTE_FROM if '/chatter' in given else HEARS_ITSELF
        elif heard:
            mistake = HEARS_BOTH
        else:
            within = any(topic.startswith(f'/{robot}/{other}/') for topic in topics)
            mistake = RELATIVE_TO if within else HEARS_NOBODY
        own = sorted(topics - {'/rosout', '/parameter_events'})
        names = ' and '.join(sorted(heard)) or 'nobody'
        raise Fail(
            f'/{robot}/listener hears {other}',
            f'it hears {names}, on {", ".join(own) or "no topic"}',
            mistake.of(robot=robot, other=other),
        )

    return Asked(f'`/{robot}/listener` receives from the talker of {other}, and no other', look)


GIVEN = Solution(
    __file__,
    'hearing.ipy',
    '',
    (
        ('each with a talker and a listener', 'that should hear each other ... and do not'),
        *ABSOLUTE_FROM.change,
        *RELATIVE_TO.change,
    ),
).code.partition('\n')[2]

exercise = Exercise(
    name='hearing',
    task='Mend hearing.launch.xml: each robot is to hear the other one.',
    clauses=(
        Launches('hearing'),
        OnlyNodes(
            [f'/{robot}/{node}' for robot in PAIRS for node in ('talker', 'listener')],
            'each of `robot1` and `robot2` has a `talker` and a `listener`, and there is no '
            'other node',
        ),
        _hears_the_other('robot1'),
        _hears_the_other('robot2'),
    ),
    stage=Launched('hearing', GIVEN),
    hints=[
        'Launch it, and look at ros2 topic list. Which names are there that nobody meant?',
        'from is read as a name in the namespace of the node, and so is to. What does a / in '
        'front do to each?',
        'from="chatter" is relative, and meets the name in the code. to="/robot1/chatter" is '
        'absolute, and leaves the namespace.',
    ],
    answer=Solution(
        __file__,
        'hearing.ipy',
        'The code says chatter, without a slash, so from has none either. The other robot is '
        'outside of the own namespace, so to begins with a slash.',
    ),
)
