"""The judge of the driving tasks: it drives, and looks at each drive clause by clause."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from labkit.exercises import Fail, Probe, expect
from labkit.exercises.clauses import Clause, Evidence
from labkit.exercises.clauses.base import naming
from labkit.lessons.turtlebot.clauses import Begins, DriveClause
from labkit.lessons.turtlebot.drawing import observed
from labkit.lessons.turtlebot.drive import Drive, Trial
from labkit.lessons.turtlebot.robot import find_robot
from labkit.lessons.turtlebot.trials import Trials

__all__ = ['driven']


def driven(
    sign: tuple[str, str],
    clauses: Sequence[Clause],
    draw: Callable[[], Sequence[Trial]],
    tell: Callable[[Sequence[Drive]], str],
    *,
    seconds: float,
) -> Callable[[Probe], str]:
    """Return a judge that drives, and looks at each drive clause by clause.

    Args:
        sign: The topic of the sign to start, and the type there.
        clauses: What the task asks for.
        draw: Draws where the drives begin, and where they lead.
        tell: Says what was seen, if all was right.
        seconds: How long a drive may take, s.
    """

    def judge(probe: Probe) -> str:
        evidence = Evidence(probe)
        for clause in clauses:
            with naming(clause):
                clause.find(evidence)
        source = evidence.publisher('/cmd_vel', evidence.subscription(sign[0]).node)
        _refuse_copies(probe, source.node, sign[0])
        if probe.in_this_process(source):
            expect.spun(probe, source)
        trials = Trials(probe, find_robot(probe), source, sign, seconds)

        def look(found: Drive) -> None:
            for clause in clauses:
                if isinstance(clause, DriveClause):
                    with naming(clause):
                        clause.look(found)

        with observed() as drives:
            with naming(next(c for c in clauses if isinstance(c, Begins))):
                trials.wait_until_quiet()
            trials.run(draw(), look, drives)
        return tell(drives)

    return judge


def _refuse_copies(probe: Probe, name: str, sign: str) -> None:
    """Raise Fail if several nodes hear the sign and drive."""
    drivers = {end.node for end in probe.publishers('/cmd_vel')}
    nodes = sorted(drivers.intersection(end.node for end in probe.subscriptions(sign)))
    copies = probe.node_names().count(name)
    if copies > 1:
        raise Fail(
            f'one node called {name}',
            f'{copies} nodes of that name',
            why='Copies of the node run at once. Each drives the robot.',
            todo='End all but one: lab.remove(...), or stop the other process or notebook.',
        )
    if len(nodes) > 1:
        raise Fail(
            f'one node that hears {sign} and publishes on /cmd_vel',
            f'{len(nodes)} of them: {", ".join(nodes[:4])}',
            why='Each of them drives the robot when the message comes.',
            todo=f'End those that you do not mean, such as lab.remove({nodes[0]!r}).',
        )
