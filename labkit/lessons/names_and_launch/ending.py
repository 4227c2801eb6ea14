"""Exercise: what ends with what, and what comes again."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked
from labkit.lessons.names_and_launch.launch_clauses import Launches, OnlyNodes
from labkit.lessons.names_and_launch.learner_launch import Launched, System

__all__ = ['exercise']

DRIVER, TALKER, LISTENER = '/robot1/driver', '/robot1/talker', '/robot1/listener'

NO_RESPAWN = Mistake(
    'ending/no-respawn',
    'A program that has died stays dead, unless its node says respawn.',
    'respawn="true" in the talker',
    change=[(' respawn="true"', '')],
)
ALL_RESPAWN = Mistake(
    'ending/all-respawn',
    'It comes again, since its node says respawn.',
    'respawn="true" in the talker, and nowhere else',
    change=[('exec="listener"/>', 'exec="listener" respawn="true"/>')],
)
ALL_END = Mistake(
    'ending/all-end',
    'Its end has ended all of them.',
    'on_exit="shutdown" in the driver, and nowhere else',
    change=[('exec="listener"/>', 'exec="listener" on_exit="shutdown"/>')],
)
LIMITED = Mistake(
    'ending/limited',
    'It was started again before, and not this time.',
    'respawn="true" alone, without respawn_max_retries',
    change=[(' respawn="true"', ' respawn="true" respawn_max_retries="1"')],
)
GOES_ON = Mistake(
    'ending/goes-on',
    'A launch goes on as long as one program of it runs, unless a node says on_exit.',
    'on_exit="shutdown" in the driver',
    change=[(' on_exit="shutdown"', '')],
)


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
    return system.wait(lambda: program.starts > before)


def _talker_comes_again(system: System) -> None:
    """Let it die, and raise Fail if it does not come again."""
    if not _comes_again(system):
        raise Fail(f'{TALKER} has died, and is started again', 'it stays dead', NO_RESPAWN)


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
    name='ending',
    task='Write a launch file that says what happens when a program ends.',
    clauses=(
        Launches('ending'),
        OnlyNodes(
            (DRIVER, TALKER, LISTENER),
            f'`{DRIVER}`, `{TALKER}` and `{LISTENER}` run, and no other node',
        ),
        Asked('when the talker dies, it is started again', _talker_comes_again),
        Asked('when the listener dies, it stays dead, and the others go on', _listener_stays_dead),
        Asked('when the driver ends, all of them end', _driver_ends_all),
    ),
    stage=Launched('ending'),
    hints=[
        'Two attributes of a node say what happens at its end: respawn and on_exit.',
        'One node says respawn="true", another on_exit="shutdown", and the third one nothing.',
        'The talker is to be started again, and the driver is required.',
    ],
    answer=Solution(
        __file__,
        'ending.ipy',
        'respawn is for a program without which the others can wait a moment. on_exit="shutdown" '
        'is for one without which they are of no use, as required was in ROS 1.',
    ),
)
