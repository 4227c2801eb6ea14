"""Runs a command that ends with the notebook, whatever ends the notebook.

Usage: python -I -S supervisor.py COMMAND [WORD ...]

Its standard input is a pipe from the kernel. When the kernel closes it or is gone, be it by
`kill -9`, the command is interrupted as by Ctrl-C, and killed if that does not help. Nothing but
Python is needed, and nothing of labkit.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import threading

# How long an interrupted command has to tidy up. A killed one stays in the ROS graph for 20 s.
GRACE_SEC = 6.0
PR_SET_PDEATHSIG = 1
# See `labkit.background.program`.
READY = 'LABKIT_READY'


def main(command: list[str]) -> int:
    """Run a command to its end.

    Args:
        command: The program and its arguments.

    Returns:
        Its exit code; as in a shell, 128 and the number of the signal that ended it.
    """
    # Who wants the command to end only says so. A handler that waited for the end would wait in
    # vain: it interrupts `child.wait()` below, which holds the lock that every wait needs.
    asked = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: asked.set())
    # A pipe on which the command may say that it is ready. It ends with the command, so it must
    # not stay open here.
    pipes = [int(os.environ[READY])] if READY in os.environ else []
    try:
        child = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
            preexec_fn=_die_too,
            pass_fds=pipes,
        )
    except OSError as error:
        print(f'{command[0]} can not be run: {error.strerror}', flush=True)
        return 127
    for pipe in pipes:
        os.close(pipe)
    threading.Thread(target=_watch, args=(asked,), daemon=True).start()
    threading.Thread(target=_stop, args=(child, asked), daemon=True).start()
    code = child.wait()
    _signal_all(child, signal.SIGKILL)  # whatever it has started and left behind
    return 128 - code if code < 0 else code


def _watch(asked: threading.Event) -> None:
    while os.read(sys.stdin.fileno(), 1):
        pass
    asked.set()


def _stop(child: subprocess.Popen[bytes], asked: threading.Event) -> None:
    asked.wait()
    for number in (signal.SIGINT, signal.SIGKILL):
        _signal_all(child, number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.wait(GRACE_SEC)
            return


def _signal_all(child: subprocess.Popen[bytes], number: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child.pid, number)


def _die_too() -> None:
    # For the case that somebody kills the supervisor itself.
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
