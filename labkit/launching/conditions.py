"""Conditions of actions: `if` and `unless`."""

from __future__ import annotations

from typing import Any

from labkit.launching.model import Condition, Context, perform, pieces, truth

__all__ = [
    'IfCondition',
    'LaunchConfigurationEquals',
    'LaunchConfigurationNotEquals',
    'UnlessCondition',
    'evaluate_condition_expression',
]


def evaluate_condition_expression(context: Context, expression: Any) -> bool:
    """Return what a text, with its substitutions made, says as a condition."""
    return truth(perform(context, pieces(expression)))


class IfCondition(Condition):
    """Hold if a text is `true` or `1`."""

    def __init__(self, predicate_expression: Any) -> None:
        text = pieces(predicate_expression)
        super().__init__(lambda context: truth(perform(context, text)))


class UnlessCondition(IfCondition):
    """Hold if a text is `false` or `0`."""

    def evaluate(self, context: Context) -> bool:
        return not super().evaluate(context)

    __call__ = evaluate


class LaunchConfigurationEquals(Condition):
    """Hold if a launch configuration has a value; None if it must not be there."""

    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        wanted = None if expected_value is None else pieces(expected_value)

        def is_equal(context: Context) -> bool:
            value = context.launch_configurations.get(launch_configuration_name)
            return value == (None if wanted is None else perform(context, wanted))

        super().__init__(is_equal)


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Hold if a launch configuration has another value."""

    def evaluate(self, context: Context) -> bool:
        return not super().evaluate(context)

    __call__ = evaluate
