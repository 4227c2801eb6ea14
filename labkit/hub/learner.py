"""A learner's server, in an account, a container or a pod: lessons first, then JupyterLab.

Run as `python -I -m labkit.hub.learner` by the hub's spawner. Options go to JupyterLab.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

__all__ = ['start']


def start(arguments: Sequence[str]) -> NoReturn:
    """Update the learner's lessons, and become their JupyterLab.

    Args:
        arguments: Further options for JupyterLab.
    """
    os.umask(0o077)
    # The course itself is shared and read-only. `labkit reset` in terminals reads this.
    os.environ.setdefault('LABKIT_WORK', str(Path.home() / 'work'))
    from labkit.course import jupyterlab, learner_folder

    for sentence in learner_folder.copy_lessons():
        print(sentence, flush=True)
    python = Path(sys.executable)
    variables = jupyterlab.lesson_variables()
    first = jupyterlab.write_home(python, variables)
    variables.setdefault('JUPYTERHUB_DEFAULT_URL', f'/lab/tree/{first}')
    # Shared memory is per account, but Fast DDS assumes one per machine. With UDP, nodes that look
    # beyond LOCALHOST, as with `lab.join()`, reach those of other learners.
    variables.setdefault('FASTDDS_BUILTIN_TRANSPORTS', 'UDPv4')
    shell = os.environ.get('SHELL') or '/bin/sh'
    options = [
        *jupyterlab.lesson_options(),
        # Sockets in the learner's home, not ports: anybody could listen to a kernel's port.
        '--KernelManager.transport=ipc',
        # A terminal is opened beside the lessons, if not in a folder of the file browser.
        '--ServerApp.terminado_settings=shell_command=/bin/sh -c '
        f"'case $PWD in $HOME) cd $LABKIT_WORK;; esac; exec {shell}'",
    ]
    # Not the lessons: where a server's own folder is deleted, it starts no kernel any more.
    os.chdir(Path.home())
    # Isolated, so that the learner's modules can't shadow those that JupyterLab needs.
    command = [str(python), '-I', '-m', 'jupyterhub.singleuser', *options, *arguments]
    os.execve(python, command, variables)


if __name__ == '__main__':
    start(sys.argv[1:])
