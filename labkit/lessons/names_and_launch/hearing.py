"""Exercise: two robots that do not hear each other."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Solution, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.names_and_launch.launch_clauses import Launches, OnlyNodes
from labkit.lessons.names_and_launch.learner_launch import Launched, System

__all__ = ['exercise']

WORDS = words_of(__file__)

# The robots, and whom each of them is to hear.
PAIRS = {'robot1': 'robot2', 'robot2': 'robot1'}

HEARS_ITSELF = WORDS.mistake('hearing/itself')
ABSOLUTE_FROM = WORDS.mistake('hearing/absolute-from')
RELATIVE_TO = WORDS.mistake('hearing/relative-to')
HEARS_BOTH = WORDS.mistake('hearing/both')
HEARS_NOBODY = WORDS.mistake('hearing/nobody')
OWN_TOPIC = WORDS.mistake('hearing/own-topic')
TALKER_REMAPPED = WORDS.mistake('hearing/talker-remapped')


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
            given = dict(system.remaps(f'/{robot}/listener'))
            mistake = ABSOLUTE_FROM if '/chatter' in given else HEARS_ITSELF
            if f'/{robot}/chatter' in given.values():
                mistake = OWN_TOPIC
            elif system.remaps(f'/{robot}/talker'):
                mistake = TALKER_REMAPPED
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

    return Asked(WORDS.of(robot=robot, other=other).clause('hears-the-other'), look)


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
    words=WORDS,
    clauses=(
        Launches('hearing'),
        OnlyNodes(
            [f'/{robot}/{node}' for robot in PAIRS for node in ('talker', 'listener')],
            WORDS.clause('only-nodes'),
        ),
        _hears_the_other('robot1'),
        _hears_the_other('robot2'),
    ),
    stage=Launched('hearing', GIVEN),
)
