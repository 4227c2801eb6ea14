"""A colcon workspace with packages of interfaces: build it, and use it in the running notebook.

`colcon build` is the real one; here are only the variables that a sourced ROS 2 has, and the ROS 2
of wheels does not. `source` does what `source install/setup.bash` does before a program starts,
for one that runs already: its loader has read LD_LIBRARY_PATH long ago, so libraries are loaded
by their paths.
"""

from __future__ import annotations

import ctypes
import hashlib
import importlib
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from labkit.background.progress_bar import ProgressBar
from labkit.errors import LabError
from labkit.setup.compiler import check_compiler, fix_exported_paths

__all__ = ['build', 'source']

# So much of what a failed build has said is shown, lines.
MOST_LINES = 12
# What was sourced: package -> what its files were then.
_sourced: dict[str, str] = {}
_libraries: dict[str, ctypes.CDLL] = {}


def build(workspace: str | os.PathLike[str]) -> list[str]:
    """Build the packages of a workspace with the real `colcon build`, and source it.

    The first build of a package of interfaces takes half a minute or more: C and C++ code is
    generated for each type, and compiled. A later one builds only what has changed.

    Args:
        workspace: The folder of the workspace. The packages are in its folder `src`.

    Returns:
        The names of the packages, sorted.

    Raises:
        LabError: There is no compiler, no package, or the build has failed; or a package was
            imported already, and has changed since.
    """
    folder = Path(workspace).resolve()
    packages = sorted({path.parent.name for path in folder.glob('src/**/package.xml')})
    if not packages:
        raise LabError(
            f'There is no package in {folder / "src"}.',
            todo='A package is a folder with a package.xml, below the folder src of a workspace.',
        )
    check_compiler()
    import numpy

    fix_exported_paths(Path(sys.prefix), numpy.get_include())
    _colcon(folder, packages)
    source(folder)
    return packages


def source(workspace: str | os.PathLike[str]) -> list[str]:
    """Let this notebook, and the processes that it starts, use what a workspace has built.

    It is what `source install/setup.bash` is for a terminal.

    Args:
        workspace: The folder of the workspace.

    Returns:
        The names of the packages, sorted.

    Raises:
        LabError: Nothing was built there; or a package was imported already, and has changed
            since: then the kernel has to be restarted.
    """
    install = Path(workspace).resolve() / 'install'
    found = {
        path.name: path
        for path in sorted(install.glob('*'))
        if (path / 'share' / 'ament_index').is_dir()
    }
    if not found:
        raise LabError(
            f'Nothing was built in {install.parent}.', todo='Build it: lab.build(workspace)'
        )
    for name, prefix in found.items():
        now = _fingerprint(prefix)
        if name in sys.modules and _sourced.get(name) != now:
            raise LabError(
                f'{name} was built anew, but this kernel has imported it as it was before.',
                todo='Restart the kernel (menu Kernel), and run the cells again: a program loads '
                'a type once.',
            )
        _sourced[name] = now
        _use(prefix)
    importlib.invalidate_caches()
    return sorted(found)


def _use(prefix: Path) -> None:
    _add_first('AMENT_PREFIX_PATH', prefix)
    _add_first('LD_LIBRARY_PATH', prefix / 'lib')
    for packages in prefix.glob('lib/python3*/site-packages'):
        _add_first('PYTHONPATH', packages)
        if str(packages) not in sys.path:
            sys.path.insert(0, str(packages))
    _load(sorted((prefix / 'lib').glob('lib*.so')))


def _add_first(variable: str, path: Path) -> None:
    known = [part for part in os.environ.get(variable, '').split(os.pathsep) if part]
    if str(path) not in known:
        os.environ[variable] = os.pathsep.join([str(path), *known])


def _load(paths: list[Path]) -> None:
    """Load libraries by their paths, each after those that it needs."""
    left = [path for path in paths if str(path) not in _libraries]
    while left:
        failed: list[Path] = []
        error: OSError | None = None
        for path in left:
            try:
                _libraries[str(path)] = ctypes.CDLL(str(path), mode=ctypes.RTLD_GLOBAL)
            except OSError as raised:
                failed.append(path)
                error = raised
        if len(failed) == len(left):
            raise LabError(f'A library that was built can not be loaded: {error}')
        left = failed


def _fingerprint(prefix: Path) -> str:
    """Return what tells one build of a package from another."""
    digest = hashlib.sha256()
    for path in sorted(prefix.glob('lib/**/*')):
        if path.is_file() and path.suffix in ('.so', '.py'):
            digest.update(str(path).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _colcon(folder: Path, packages: list[str]) -> None:
    command = [
        *(str(Path(sys.executable).parent / 'colcon'), '--log-base', 'log', 'build'),
        *('--event-handlers', 'console_direct+', '--cmake-args'),
        *(f'-DPython3_EXECUTABLE={sys.executable}', '-DBUILD_TESTING=OFF'),
    ]
    bar = ProgressBar('colcon build')
    said: list[str] = []
    process = subprocess.Popen(
        command,
        cwd=folder,
        env=_variables(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors='replace',
        start_new_session=True,
    )
    assert process.stdout is not None
    try:
        for line in process.stdout:
            said.append(line.rstrip())
            percent = re.match(r'\[ *(\d+)%\] (.*)', line)
            if percent:
                bar.show(int(percent[1]) / 100, percent[2].strip()[:80])
            elif line.startswith(('Starting', '--')):
                bar.show(None, line.strip()[:80])
        code = process.wait()
    except BaseException:  # the stop button, too
        os.killpg(process.pid, signal.SIGTERM)
        process.wait()
        raise
    finally:
        process.stdout.close()
        bar.close()
    if code:
        raise LabError(
            f'colcon build of {", ".join(packages)} has failed:\n' + '\n'.join(_reasons(said)),
            todo='Mend what it says, and build again.',
        )


def _variables() -> dict[str, str]:
    """Return the variables that a sourced ROS 2 would have."""
    variables = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(('COLCON_', 'CMAKE_', 'PYTEST_'))
    }
    variables['AMENT_PREFIX_PATH'] = variables['CMAKE_PREFIX_PATH'] = sys.prefix
    scripts = str(Path(sys.executable).parent)
    variables['PATH'] = os.pathsep.join([scripts, variables.get('PATH', '')])
    # A `setup.py` or an empy template of an old style warns; that is no news for a learner.
    variables['PYTHONWARNINGS'] = 'ignore'
    return variables


def _reasons(said: list[str]) -> Iterator[str]:
    """Yield the lines of a failed build that say why, at most `MOST_LINES`."""
    error = re.compile(r'(?i)\berror\b|Invalid|Exception|not found')
    noise = re.compile(r'Traceback|^\s+File |Call Stack|g?make|returned error code')
    found = [line for line in said if error.search(line) and not noise.search(line)]
    yield from list(dict.fromkeys(found or said))[:MOST_LINES]
