"""Ways in which a program ends its process. In a callback they end the program, not the kernel.

Each of them raises there what ends a program (`foreground.ENDS`). Everywhere else, as in a cell,
in a thread of its own or in a forked process, it does what it always does.
"""

from __future__ import annotations

import _thread
import functools
import os
import signal
import sys
from collections.abc import Callable
from typing import Any

import rclpy.executors
import rclpy.task

from labkit import settings, stop_button

__all__ = ['install', 'uninstall']

# Each callback, whoever runs it, is called by one of these files.
_CALLERS = (rclpy.executors.__file__, rclpy.task.__file__)
# By default, these do nothing. All others end a process, or stop it, and a kernel that is stopped
# is of as little use.
_HARMLESS = ('SIGCHLD', 'SIGCONT', 'SIGURG', 'SIGWINCH')
# The signal at the end of each timer of `setitimer`, by number.
_OF_TIMERS = (signal.SIGALRM, signal.SIGVTALRM, signal.SIGPROF)

End = BaseException | None


def _exit(status: object = None) -> End:
    return SystemExit(status)


def _abort() -> End:
    return SystemExit(128 + signal.SIGABRT)


def _ask_exit() -> End:  # `exit()` and `quit()` in a kernel
    return SystemExit()


def _signalled(number: int = signal.SIGINT) -> End:
    try:
        handler = signal.getsignal(number)
    except (TypeError, ValueError):
        return None  # no signal: `os.kill(pid, 0)` asks whether a process is alive
    if callable(handler) and not stop_button.is_usual(handler):
        return None  # the program's own handler
    if number == signal.SIGINT:  # which the kernel ignores between cells
        return KeyboardInterrupt()
    ignored = handler is signal.SIG_IGN or any(number == getattr(signal, n) for n in _HARMLESS)
    return None if ignored else SystemExit(128 + number)


def _killed(pid: int, number: int) -> End:
    group = os.getpgrp()
    return _signalled(number) if pid in (os.getpid(), 0, -1, -group) else None


def _group_killed(group: int, number: int) -> End:
    return _signalled(number) if group in (0, os.getpgrp()) else None


def _thread_killed(_: int, number: int) -> End:
    return _signalled(number)


def _alarmed(seconds: float) -> End:
    return _signalled(signal.SIGALRM) if seconds else None


def _timed(timer: int, seconds: float, *_: float) -> End:
    return _signalled(_OF_TIMERS[timer]) if seconds else None


def _executed(path: object, *_: object) -> End:
    return SystemExit(f'os.exec of {path}')


_WAYS: tuple[tuple[Any, str, Callable[..., End]], ...] = (
    (os, '_exit', _exit),
    (os, 'abort', _abort),
    (os, 'execv', _executed),  # all others of its kind call one of these two
    (os, 'execve', _executed),
    (os, 'kill', _killed),
    (os, 'killpg', _group_killed),
    (signal, 'alarm', _alarmed),
    (signal, 'pthread_kill', _thread_killed),
    (signal, 'raise_signal', _signalled),
    (signal, 'setitimer', _timed),
    (_thread, 'interrupt_main', _signalled),
)
_replaced: list[tuple[Any, str, Any, Any]] = []


def install() -> None:
    """Put the replacements in place, in a kernel."""
    shell = settings.shell()
    for owner, name, end in (*_WAYS, (shell, 'ask_exit', _ask_exit)):
        original = getattr(owner, name)
        guarded = _guarded(original, end, os.getpid())
        setattr(owner, name, guarded)
        _replaced.append((owner, name, original, guarded))


def uninstall() -> None:
    """Put the originals back, except what other code has replaced since."""
    for owner, name, original, guarded in _replaced:
        if getattr(owner, name) is guarded:
            setattr(owner, name, original)
    _replaced.clear()


def _guarded(original: Callable[..., Any], end: Callable[..., End], kernel: int) -> Any:
    @functools.wraps(original)
    def function(*args: Any, **kwargs: Any) -> Any:
        if os.getpid() == kernel and _in_callback():
            error = end(*args, **kwargs)
            if error is not None:
                raise error
        return original(*args, **kwargs)

    return function


def _in_callback() -> bool:
    frame = sys._getframe(2)
    while frame is not None:
        if frame.f_code.co_filename in _CALLERS:
            return True
        frame = frame.f_back  # type: ignore[assignment]
    return False
