"""Run a command that ends with the notebook, however the notebook ends.

Usage: python -I -S supervisor.py COMMAND [WORD ...]

Its standard input is a pipe from the kernel. When the kernel closes it or is gone, even by
`kill -9`, the command is interrupted as by Ctrl-C, and killed if that does not help. It needs
only Python, and nothing of labkit.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import threading

# How long an interrupted command may clean up. A killed one stays in the ROS graph for 20 s.
GRACE_SEC = 6.0
PR_SET_PDEATHSIG = 1
# See `labkit.programs.program`.
READY = 'LABKIT_READY'


def main(command: list[str]) -> int:
    """Run a command to its end, and return its exit code as a shell does.

    That is 128 plus the signal's number if a signal has ended it.
    """
    # The handler only sets an event. One that waited for the end would wait in vain: it interrupts
    # `child.wait()` below, which holds the lock that every wait needs.
    asked = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: asked.set())
    # The pipe on which the command may announce its nodes. Its reader waits for the end of the
    # command, so it must not stay open here.
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
    _signal_all(child, signal.SIGKILL)  # processes that it has left behind
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
    # In case the supervisor itself is killed.
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
