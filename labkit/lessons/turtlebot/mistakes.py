"""Wrong answers that several exercises of this lesson have."""

from __future__ import annotations

from labkit.exercises import Outcome, Wrong, changed

__all__ = ['int_for_float', 'own_clock']


def own_clock(code: str) -> Wrong:
    """Return a solution without the parameter that lets it follow the clock of the robot."""
    without = changed(code, (', parameter_overrides=[SIM_TIME]', ''))
    return Wrong('its own clock', without, 'The node follows its own clock')


def int_for_float(code: str, old: str, new: str) -> Wrong:
    """Return a solution that puts an int into a field of a Twist.

    Args:
        code: The solution.
        old: What stands there.
        new: The same with an int.
    """
    return Wrong(
        'an int in a float field',
        changed(code, (old, new)),
        'takes values of type float',
        outcome=Outcome.ERROR,
    )
