"""A learner's server, in an account, a container or a pod: their lessons, then JupyterLab.

Run as `python -m labkit.hub.learner` by the hub's spawner. Options go to JupyterLab.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

__all__ = ['start']


def start(arguments: Sequence[str]) -> NoReturn:
    """Bring the learner's lessons up to date, and become their JupyterLab.

    Args:
        arguments: Options for JupyterLab, besides those set here.
    """
    os.umask(0o077)
    # The course itself is everybody's and stays as it is. In terminals `labkit reset` reads this.
    os.environ.setdefault('LABKIT_WORK', str(Path.home() / 'work'))
    from labkit.course import jupyterlab, learner_folder

    for sentence in learner_folder.copy_lessons():
        print(sentence, flush=True)
    python = Path(sys.executable)
    variables = jupyterlab.lesson_variables()
    first = jupyterlab.write_home(python, variables)
    variables.setdefault('JUPYTERHUB_DEFAULT_URL', f'/lab/tree/{first}')
    # Shared memory belongs to one account, and Fast DDS takes it for everybody on a machine. Nodes
    # that look beyond LOCALHOST, as `lab.join()` does, find those of other learners so.
    variables.setdefault('FASTDDS_BUILTIN_TRANSPORTS', 'UDPv4')
    options = [
        *jupyterlab.lesson_options(),
        # Sockets in the learner's home, not ports: on a port of this machine everybody can listen
        # to what a kernel publishes.
        '--KernelManager.transport=ipc',
    ]
    os.chdir(learner_folder.WORK)
    # Isolated: no module of the learner's takes the place of one that JupyterLab needs.
    command = [str(python), '-I', '-m', 'jupyterhub.singleuser', *options, *arguments]
    os.execve(python, command, variables)


if __name__ == '__main__':
    start(sys.argv[1:])
