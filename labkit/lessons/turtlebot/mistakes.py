"""Wrong answers that several exercises of this lesson have."""

from __future__ import annotations

from labkit.exercises import Outcome, Wrong, changed

__all__ = ['first_time_only', 'int_for_float']


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


def first_time_only(code: str, line: str) -> Wrong:
    """Return a solution that drives at the first sign, and never again.

    Args:
        code: The solution.
        line: The line of the callback that begins a drive.
    """
    old = f'        {line}\n'
    new = f'        if not self.used:\n            self.used = True\n            {line}\n'
    made = '        self.publisher ='
    return Wrong(
        'the first time only',
        changed(code, (made, f'        self.used = False\n{made}'), (old, new)),
        'Something is used up by the first drive',
    )
