"""Exercise: what ends with what, and what comes again."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.figures import figure
from labkit.lessons.names_and_launch.launch_clauses import Launches, OnlyNodes
from labkit.lessons.names_and_launch.learner_launch import Launched, System

__all__ = ['exercise']

WORDS = words_of(__file__)

# So soon it has to be started again, s.
SOON_SEC = 5.0
DRIVER, TALKER, LISTENER = '/robot1/driver', '/robot1/talker', '/robot1/listener'

NO_RESPAWN = WORDS.mistake('ending/no-respawn')
SLOW_RESPAWN = WORDS.mistake('ending/slow-respawn')
ALL_RESPAWN = WORDS.mistake('ending/all-respawn')
ALL_END = WORDS.mistake('ending/all-end')
LIMITED = WORDS.mistake('ending/limited')
COUNTED = WORDS.mistake('ending/counted')
GOES_ON = WORDS.mistake('ending/goes-on')


def _refuse_second(system: System, node: str) -> None:
    """Let a node die, and raise Fail if it comes again."""
    program = system.kill(node)
    if program.again or program.starts > 1:
        raise Fail(f'{node} has died, and stays dead', 'it is started again', ALL_RESPAWN)


def _comes_again(system: System) -> bool:
    """Let the talker die, and tell whether it is started again."""
    program = system.programs[TALKER]
    before = program.starts
    system.kill(TALKER)
    if program.starts == before and not program.again:
        return False
    if program.again and program.delay > SOON_SEC:
        raise Fail(
            f'{TALKER} has died, and is started again within {figure(SOON_SEC)} s',
            f'it is started again after {figure(program.delay)} s',
            SLOW_RESPAWN,
        )
    system.wait(lambda: program.starts > before or not system.launch.running)
    return program.starts > before


def _talker_comes_again(system: System) -> None:
    """Let it die, and raise Fail if it does not come again."""
    if not _comes_again(system):
        raise Fail(f'{TALKER} has died, and is started again', 'it stays dead', NO_RESPAWN)
    times = system.programs[TALKER].left
    if times >= 0:
        raise Fail(
            f'{TALKER} is started again each time',
            f'it is started again {times} {"times" if times > 1 else "time"}, and no more',
            COUNTED,
        )


def _listener_stays_dead(system: System) -> None:
    """Let it die, and raise Fail if it comes again, or others end."""
    _refuse_second(system, LISTENER)
    # A launch that ends starts nothing again.
    if not _comes_again(system):
        if system.launch.shutting_down:
            raise Fail('the others go on without the listener', 'all of them end', ALL_END)
        raise Fail(f'{TALKER} is started again each time', 'it stays dead', LIMITED)


def _driver_ends_all(system: System) -> None:
    """End it, and raise Fail if another one goes on."""
    _refuse_second(system, DRIVER)
    if _comes_again(system):
        raise Fail('all of them end', f'{TALKER} goes on', GOES_ON)
    system.wait(lambda: not system.launch.running)


exercise = Exercise(
    words=WORDS,
    clauses=(
        Launches('ending'),
        OnlyNodes(
            (DRIVER, TALKER, LISTENER),
            WORDS.clause('only-nodes'),
        ),
        Asked(
            WORDS.of(seconds=figure(SOON_SEC)).clause('talker-comes-again'), _talker_comes_again
        ),
        Asked(WORDS.clause('listener-stays-dead'), _listener_stays_dead),
        Asked(WORDS.clause('driver-ends-all'), _driver_ends_all),
    ),
    stage=Launched('ending'),
)
