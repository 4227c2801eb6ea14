"""Set and get the parameters of a node under test, and give them back as they were."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from labkit import stop_button
from labkit.errors import LabError
from labkit.exercises import common_mistakes
from labkit.exercises.expect.spinning import hanging
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['Values', 'asked', 'get_values', 'kept', 'set_values']

Values = Mapping[str, Any]
"""Values of parameters, by their names."""


def _messages(values: Values) -> list[Any]:
    from rclpy.parameter import Parameter

    make: Any = Parameter
    return [make(name, value=value).to_parameter_msg() for name, value in values.items()]


def set_values(probe: Probe, node: str, values: Values) -> str | None:
    """Set parameters of a node, several of them at once.

    Returns:
        None, or why the node refuses; '' if it does not say.

    Raises:
        LearnerError: One of its callbacks has raised.
        Fail: It does not answer.
    """
    from labkit.asking.parameter_calls import set_parameters, set_parameters_atomically

    with asked(probe, node):
        if len(values) > 1:
            result = set_parameters_atomically(probe.spun_node, node, _messages(values))
        else:
            result = set_parameters(probe.spun_node, node, _messages(values))[0]
    return None if result.successful else str(result.reason)


def get_values(probe: Probe, node: str, names: list[str]) -> dict[str, Any]:
    """Return values of a node's parameters by their names; raises as `set_values` does."""
    from labkit.asking.parameter_calls import get_parameters
    from labkit.rosgraph.parameter_values import python_value

    with asked(probe, node):
        found = get_parameters(probe.spun_node, node, names)
    return {name: python_value(value) for name, value in found.items()}


@contextmanager
def kept(probe: Probe, node: str, names: list[str]) -> Iterator[Values]:
    """Give parameters back the values that they had before; these are what the block gets."""
    before = get_values(probe, node, names)
    try:
        yield before
    finally:
        with stop_button.undoing():
            if before:
                set_values(probe, node, before)


@contextmanager
def asked(probe: Probe, node: str) -> Iterator[None]:
    """Say what is wrong with a node that does not answer.

    Raises:
        LearnerError: One of its callbacks has raised.
        Fail: It does not answer.
    """
    try:
        yield
    except LabError as error:
        probe.callbacks.raise_new_error(probe.scope)
        hanging()
        raise Fail(
            f'{node} answers questions about its parameters',
            error.message,
            common_mistakes.PARAMETERS_SILENT,
        ) from None
