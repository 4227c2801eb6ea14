"""The command `labkit physics`: install what a world with physics needs. Runs in a bare Python."""

from __future__ import annotations

from labkit.errors import SetupError
from labkit.setup.environment import make_environment
from labkit.setup.machine import run

__all__ = ['REQUIREMENTS', 'install_physics']

REQUIREMENTS = ('environment.txt', 'labkit/sim/physics/requirements.txt')


def install_physics() -> str:
    """Bring the environment up to date, and return a sentence on what is possible now.

    Raises:
        SetupError: It can't be installed, or MuJoCo has no wheel for the environment's Python.
    """
    python = make_environment(REQUIREMENTS)
    if run([str(python), '-I', '-c', 'import mujoco']).returncode != 0:
        raise SetupError(
            'MuJoCo can not be loaded in this environment. It has wheels for Python 3.11 and '
            f'newer, and the environment is made with {python}.',
            todo='With another Python: delete the folder .venv, and repeat the command with '
            'python3.12.',
        )
    return 'Worlds with physics can be made: lab.Turtlebot(physics=True)'
