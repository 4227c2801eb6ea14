"""A spin in the foreground: what a callback of its nodes raises comes out of it, as in a script.

The callbacks run in the background thread, which hands over what they raise. If nobody catches it,
it ends the cell. What ends a program, such as `sys.exit()`, then ends the nodes of the spin.
"""

from __future__ import annotations

import threading
import traceback
from collections import deque
from collections.abc import Sequence
from typing import cast

import rclpy.executors
from rclpy.node import Node

from labkit.background.nodes import full_name, node_exists
from labkit.background.tracebacks import is_learners
from labkit.errors import first_few, quoted

__all__ = ['ENDS', 'Spin', 'ended_nodes', 'in_words', 'last_words', 'swallowed']

ENDS = (SystemExit, KeyboardInterrupt)
"""What a callback raises to end its program."""

# The attribute of an exception that has its spin.
_MARK = '_labkit_spin'
# What has left the spins of the running cell.
_left: deque[BaseException] = deque(maxlen=100)


class Spin:
    """One spin in the foreground.

    Args:
        what: Its call, such as `rclpy.spin()`.
        nodes: The nodes that it spins.

    Attributes:
        error: What a callback has raised, to come out of the spin.
        callback: The name of that callback.
        lasts: Whether its node runs in the background all the same.
        busy: The name of a callback that runs on after it; nothing can interrupt that.
    """

    def __init__(self, what: str, nodes: Sequence[Node]) -> None:
        self.what = what
        self.nodes = nodes
        self.error: BaseException | None = None
        self.callback = ''
        self.lasts = False
        self.busy = ''
        self._names = [full_name(node) for node in nodes]
        self._lock = threading.Lock()
        self._closed = False

    @property
    def is_over(self) -> bool:
        """Return whether a callback has ended it."""
        return self.error is not None

    def take(self, error: BaseException, callback: str) -> bool:
        """Take what a callback has raised; return False if the spin has ended already."""
        with self._lock:
            if self._closed:
                return False
            self._closed, self.error, self.callback = True, error, callback
            return True

    def close(self) -> None:
        """Take nothing any more."""
        with self._lock:
            self._closed = True

    def mark(self, error: BaseException) -> None:
        """Note on an exception that it leaves this spin; the outermost one marks it last."""
        vars(error)[_MARK] = self
        if isinstance(error, ENDS) and _in_cell():
            _left.append(error)

    def ends_program(self, error: BaseException) -> bool:
        """Return whether an exception that left it ends its nodes; the stop button does not."""
        if isinstance(error, KeyboardInterrupt):
            return error is self.error or not _in_cell()  # no button interrupts a thread
        return isinstance(error, ENDS)

    def last_words(self, error: BaseException) -> str:
        """Return how it has ended, and what has become of its nodes."""
        names = first_few(self._names)
        if self.ends_program(error):
            who = f'{self.callback} of {names}' if self.callback else 'A callback'
            ended = ' and '.join(filter(None, [self.what, names]))
            return f'{who} has {in_words(error)}. In a notebook that ends {ended} alone.'
        if not names:  # the executor was shut down since
            fate = ''
        elif self.lasts:
            fate = f'{names} goes on in the background, where lab.spin() runs it.'
        elif any(map(node_exists, self.nodes)):
            fate = f'No longer spun: {names}.'
        else:
            fate = f'Ended: {names}.'
        if isinstance(error, KeyboardInterrupt):
            busy = f'{self.busy} still runs, and until it has returned, no other callback does.'
            words = [f'{self.what} was interrupted.', fate, busy if self.busy else '']
            return ' '.join(filter(None, words))
        return f'{self.what} has ended with this error. {fate}'.rstrip()


def in_words(error: BaseException) -> str:
    """Return what a callback has done that has raised one of `ENDS`."""
    code = f': {quoted(error.args[0])}' if error.args else ''
    return f'ended its program ({type(error).__name__}{code})'


def last_words(error: BaseException) -> str:
    """Return how a spin has ended that an exception has left; '' if it has left none."""
    spin = _left_by(error)
    return spin.last_words(error) if spin is not None else ''


def ended_nodes(error: BaseException) -> dict[Node, str]:
    """Return the nodes that end because nobody has caught an exception: what a callback did."""
    spin = _left_by(error)
    if spin is None or not spin.ends_program(error):
        return {}
    return dict.fromkeys(spin.nodes, f'{spin.callback} {in_words(error)}'.strip())


def swallowed() -> list[BaseException]:
    """Return, once, what has ended a spin in this cell and was caught by IPython alone.

    IPython is silent when a file of `%run` ends with `sys.exit(0)`.
    """
    errors = list(_left)
    _left.clear()
    return [error for error in errors if not _caught_by_learner(error)]


def _in_cell() -> bool:
    return threading.current_thread() is threading.main_thread()


def _caught_by_learner(error: BaseException) -> bool:
    # The first frame of a traceback is the one that has caught it.
    tb = error.__traceback__
    return tb is not None and is_learners(tb.tb_frame.f_code.co_filename)


def _left_by(error: BaseException) -> Spin | None:
    """Return the outermost spin that an exception has left."""
    spin = vars(error).get(_MARK)
    if spin is not None:
        return cast(Spin, spin)
    for frame, _ in traceback.walk_tb(error.__traceback__):
        # The learner's own executor, spun by rclpy's own functions in the cell.
        code = frame.f_code
        if code.co_filename == rclpy.executors.__file__ and code.co_name.startswith('spin'):
            return Spin(f'executor.{code.co_name}()', frame.f_locals['self'].get_nodes())
    return None
