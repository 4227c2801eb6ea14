"""Count the learner's callbacks during a check, and notice when they raise."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from labkit.exercises.verdict import LearnerError
from labkit.exercises.what_is_asked import PUBLISHER, SERVICE, SUBSCRIPTION, Scope

__all__ = ['Callbacks', 'find_node', 'is_given']

# Stands for all cell ids: a node of this name is never the learner's.
ANY_CELL = '*'


class Callbacks:
    """The callbacks of this notebook's nodes since it was made."""

    def __init__(self) -> None:
        from labkit.background.runtime import runtime

        self._runtime = runtime
        # The errors and not their ids, which Python reuses.
        self._before = [(error, error.count) for error in runtime.console.errors]

    def count(self, node: Any, entity: Any) -> int | None:
        """Return the number of callbacks run for a timer or subscription.

        None if labkit does not run them, but, for instance, the learner's own executor.
        """
        entry = self._runtime.entry_of(node)
        return None if entry is None else entry.counts.get(entity, 0)

    def raise_new_error(self, scope: Scope) -> None:
        """Raise LearnerError if a callback of a node under test has raised during the check."""
        for error in tuple(self._runtime.console.errors):
            before = next((count for known, count in self._before if known is error), 0)
            if error.count > before and _is_under_test(error, scope):
                raise _learner_error(error)

    def raise_old_error(self, scope: Scope, nodes: Collection[str] | None = None) -> None:
        """Raise LearnerError if a node under test that still runs raised before the check.

        Args:
            scope: What the lesson looks at.
            nodes: Full names of those that it is about; all if None.
        """
        for error in reversed(self._runtime.console.errors):
            if nodes is not None and error.node_name not in nodes:
                continue
            if _is_under_test(error, scope) and _is_of_running_node(error):
                raise _learner_error(error)


def find_node(name: str) -> Any:
    """Return the node object of a name, None if it is not in this process."""
    from labkit.background.runtime import runtime

    for entry in runtime.nodes():
        if entry.name == name:
            return entry.node
    for node in runtime.unspun_nodes():
        if node.get_fully_qualified_name() == name:
            return node
    return None


def is_given(name: str, scope: Scope) -> bool:
    """Return whether the node of a full name is the lesson's own, and not the learner's."""
    if name not in scope.given:
        return False
    from labkit.background.runtime import runtime

    cells = scope.given[name].split()
    if ANY_CELL in cells:
        return True
    if find_node(name) is None:
        return not cells  # in another process, so no cell has made it
    made_in = next((e.cell.cell_id for e in runtime.nodes() if e.name == name), '')
    # Some front ends don't send the id of a cell.
    return not made_in or made_in in cells


def _is_under_test(error: Any, scope: Scope) -> bool:
    node = find_node(error.node_name)
    if node is None or is_given(error.node_name, scope):
        return False
    roles = {(PUBLISHER, publisher.topic_name) for publisher in node.publishers}
    roles |= {(SUBSCRIPTION, subscription.topic_name) for subscription in node.subscriptions}
    roles |= {(SERVICE, service.service_name) for service in node.services}
    # A node that has none of the lesson's topics may be a first try with wrong names.
    return bool(roles & scope.own.keys()) or not any(topic in scope.known for _, topic in roles)


def _is_of_running_node(error: Any) -> bool:
    """Tell a node's own error from one of an earlier node of the same name."""
    node = find_node(error.node_name)
    traceback = error.error.__traceback__
    while traceback is not None:
        if any(value is node for value in traceback.tb_frame.f_locals.values()):
            return True
        traceback = traceback.tb_next
    return False


def _learner_error(error: Any) -> LearnerError:
    where = f'The callback {error.callback} of {error.node_name}'
    return LearnerError(where, error.error, error.text)
