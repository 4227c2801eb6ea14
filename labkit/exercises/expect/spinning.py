"""Matchers for whether callbacks run: none that does not return, and a node that is spun."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from labkit.errors import LabError
from labkit.exercises import common_mistakes
from labkit.exercises.learner_errors import last_cell
from labkit.exercises.mistakes import Mistake
from labkit.exercises.probe import Probe
from labkit.exercises.time.hanging import Hanging, find_hanging
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = [
    'earlier',
    'hanging',
    'how_to_spin',
    'not_spun',
    'outlasts',
    'overloaded',
    'runs',
    'spun',
]


def hanging(found: Hanging | None = None) -> None:
    """Raise Fail if a callback of this notebook is running and does not return.

    Args:
        found: What was found not to return; it is looked for if None.

    Raises:
        LabError: It is a callback of a node that was replaced: no fault of what is checked.
    """
    found = found or find_hanging()
    if found is None:
        return
    earlier(found)
    where = f' ({found.line})' if found.line else ''
    if not found.node:
        raise Fail(
            'callbacks of this notebook that run',
            f'none of them has run for a while, though some were ready{where}',
            common_mistakes.NOTHING_RUNS,
        )
    raise Fail(
        'callbacks that return at once',
        f'the callback {found.callback} of {found.node} is still running{where}',
        common_mistakes.BLOCKS,
    )


def earlier(found: Hanging | None = None) -> None:
    """Raise LabError if a callback of a node that has ended does not return.

    Args:
        found: What was found not to return; it is looked for if None.
    """
    found = found or find_hanging()
    if found is None or not found.ended:
        return
    where = f' ({found.line})' if found.line else ''
    raise LabError(
        f'{found.callback} of an earlier {found.node}, which has ended, still runs{where}: until '
        'it returns, no callback of the new one can.',
        todo='Wait until it has returned, then run the cell of the node and this one again. If it '
        'never returns, restart the kernel (menu Kernel), and run the cells from the top.',
    )


def overloaded(found: Hanging) -> NoReturn:
    """Raise Fail: a callback or a thread needs more time than there is."""
    who = f'the callback {found.callback} of {found.node}' if found.node else 'a thread'
    where = f' ({found.line})' if found.line else ''
    raise Fail(
        'callbacks and threads that need less time than passes',
        f'{who} is at work for longer than passes{where}',
        outlasts(found) or common_mistakes.OVERLOADED,
    )


def outlasts(found: Hanging | None) -> Mistake | None:
    """Return what is wrong with a callback that takes longer than the period of its timer."""
    if found is None or not 0 < found.period < found.took:
        return None
    return common_mistakes.OUTLASTS.of(
        callback=found.callback, took=found.took, period=found.period
    )


def spun(probe: Probe, endpoint: Endpoint) -> None:
    """Raise Fail if nobody runs the callbacks of an endpoint's node."""
    if not runs(probe, endpoint.node):
        raise Fail(
            f'{endpoint.node} takes its messages and calls its callbacks',
            f'{endpoint.node} is there, but it is not spun',
            not_spun(
                probe,
                endpoint.node,
                common_mistakes.NOT_TAKEN.of(spin=how_to_spin(probe, endpoint.node)),
            ),
        )


def not_spun(probe: Probe, name: str, usual: Mistake) -> Mistake:
    """Return why nobody spins a node: its cell was stopped before, or what usually is the case."""
    from labkit.background.nodes import made

    node = probe.node_object(name)
    origin = made.origins.get(node) if node is not None else None
    run = last_cell.run_of(origin.cell.cell_id) if origin is not None else None
    if origin is None or run is None or run.number != origin.cell.number or not run.stopped_in:
        return usual
    return common_mistakes.INIT_WAITS.of(line=run.stopped_in)


def how_to_spin(probe: Probe, name: str) -> str:
    """Say how a node of this process, or of another one, is spun."""
    if probe.node_object(name) is None:
        return 'Call rclpy.spin(node) in its program.'
    return 'Hand the node over: lab.spin(node)'


def runs(probe: Probe, name: str) -> bool:
    """Tell whether somebody runs the callbacks of a node.

    A node of another process is asked a question, and has until the check's time is over to
    answer. One without parameter services can't be asked, and counts as spun.
    """
    node = probe.node_object(name)
    if node is not None:
        return node.executor is not None
    from labkit.asking.service_calls import wait_until_spun

    service, asker = f'{name}/list_parameters', probe.spun_node
    # Services come into the graph after the name of their node.
    found = probe.wait_to_appear(lambda: service in dict(asker.get_service_names_and_types()))
    with probe.uncounted():
        return not found or wait_until_spun(asker, name, probe.time_left)
