"""Let a kernel of somebody else's use the environment: `%run ros-course/labkit/setup/kernel.py`.

Where the kernel is not ours to choose, as in Google Colab, it goes on with its own packages, and
none of them is replaced. What it lacks, ROS above all, it finds in the environment, and the
processes that it starts are in the environment altogether.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Sequence
from pathlib import Path

_ROOT = str(Path(__file__).resolve().parents[2])
if _ROOT not in sys.path:
    sys.path.append(_ROOT)

from labkit.errors import SetupError  # noqa: E402 - it is found now
from labkit.setup.environment import VENV, environment_variables, make_environment  # noqa: E402

__all__ = ['enter_environment']

_NOT_FOUND = ': cannot open shared object file'


def enter_environment() -> None:
    """Make the environment if need be, and let this process use it from now on.

    Raises:
        SetupError: It can't be made on this machine, or is one of another Python.
    """
    python = make_environment()
    if os.path.realpath(sys.prefix) == os.path.realpath(VENV):
        return
    packages = VENV / 'lib' / 'python{}.{}'.format(*sys.version_info[:2]) / 'site-packages'
    if not packages.is_dir():
        raise SetupError(
            f'This kernel is Python {sys.version_info[0]}.{sys.version_info[1]}, and the '
            f'environment {str(VENV)!r} is made with another one.',
            todo='Choose a kernel with Python 3.10, 3.11, 3.12 or 3.13, delete that folder, and '
            'run this again.',
        )
    # Last, so that each package that the kernel has, stays its own.
    sys.path.append(str(packages))
    sys.prefix = sys.exec_prefix = str(VENV)
    sys.executable = str(python)
    os.environ.update(environment_variables())
    _load_libraries(packages, [VENV / 'lib', *sorted(packages.glob('ros_*.libs'))])


def _load_libraries(packages: Path, folders: Sequence[Path]) -> None:
    """Load what ROS would look for by name.

    The wheels restart Python once to set `LD_LIBRARY_PATH`. A kernel can't be restarted by a cell,
    and its loader has read the variable long ago. But what is loaded is not looked for.
    """
    known = [os.environ.get('LD_LIBRARY_PATH', '')]
    os.environ['LD_LIBRARY_PATH'] = os.pathsep.join(
        [*map(str, folders), *filter(None, known)]
    )  # rcpputils reads it each time
    names = ['librmw_fastrtps_cpp.so']
    names += sorted(path.name for path in folders[0].glob('lib*__rosidl_*.so'))
    extensions = [*packages.glob('rclpy/*.so'), *packages.glob('*/*__rosidl_typesupport_*.so')]
    for name in [*names, *map(str, sorted(extensions))]:
        _load(name, folders)


def _load(name: str, folders: Sequence[Path]) -> None:
    """Load a library, and before it those that it needs."""
    path = next((str(folder / name) for folder in folders if (folder / name).exists()), name)
    while True:
        try:
            ctypes.CDLL(path)
        except OSError as error:
            missing, found, _ = str(error).partition(_NOT_FOUND)
            if not found or missing in (name, path):
                raise
            _load(missing, folders)
        else:
            return


if __name__ == '__main__':
    enter_environment()
