"""Build a colcon workspace with interface packages, and use it in the running notebook.

`colcon build` is the real one; this adds only the variables that a sourced ROS 2 has, and ROS 2
from wheels lacks. `source` does for a running program what `source install/setup.bash` does before
one starts. The loader reads LD_LIBRARY_PATH only at start, so libraries are loaded by path.
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
from collections.abc import Iterator, Mapping
from pathlib import Path

from labkit.errors import LabError, first_few
from labkit.progress_bar import ProgressBar
from labkit.rosgraph.workspaces import (
    any_failed_build,
    build_result,
    other_python,
    setup_fails,
    source_of,
)
from labkit.setup.compiler import check_compiler, fix_exported_paths

__all__ = ['build', 'colcon', 'load_libraries', 'source']

# Most lines of a failed build to show.
MOST_LINES = 12
# Those of an error of syntax.
SETUP_LINES = 4
# Sourced package -> fingerprint of its files.
_sourced: dict[str, str] = {}
_libraries: dict[str, ctypes.CDLL] = {}


def build(workspace: str | os.PathLike[str]) -> list[str]:
    """Build the packages of a workspace with the real `colcon build`, and source it.

    The first build of a package of interfaces takes half a minute or more: C and C++ code is
    generated for each type, and compiled. A later one builds only what has changed.

    Args:
        workspace: The folder of the workspace, with the packages in its folder `src`.

    Returns:
        The names of the packages, sorted.

    Raises:
        LabError: There is no package, no compiler for one of interfaces, or the build has failed;
            or a package was imported already, and has changed since.
    """
    folder = Path(workspace).resolve()
    packages = sorted({path.parent.name for path in folder.glob('src/**/package.xml')})
    if not packages:
        raise LabError(
            f'There is no package in {folder / "src"}.',
            todo='A package is a folder with a package.xml, below the folder src of a workspace.',
        )
    if any(folder.glob('src/**/CMakeLists.txt')):
        check_compiler()
        import numpy

        fix_exported_paths(Path(sys.prefix), numpy.get_include())
    colcon(folder, packages)
    source(folder)
    return packages


def source(workspace: str | os.PathLike[str]) -> list[str]:
    """Let this notebook, and the processes that it starts, use a workspace that was built.

    This is what `source install/setup.bash` is for a terminal.

    Args:
        workspace: The folder of the workspace.

    Returns:
        The names of the packages, sorted.

    Raises:
        LabError: Nothing was built there; or for another Python, and what is compiled for that can
            not be loaded; or a package was imported already, and has changed since: then the
            kernel has to be restarted.
    """
    install = Path(workspace).resolve() / 'install'
    found = {
        path.name: path
        for path in sorted(install.glob('*'))
        if (path / 'share' / 'ament_index').is_dir()
    }
    if not found:
        raise LabError(
            f'Nothing was built in {install.parent}.',
            todo=any_failed_build(install.parent) or 'Build it: lab.build(workspace)',
        )
    _compare_pythons(install.parent, found)
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


def _compare_pythons(workspace: Path, found: Mapping[str, Path]) -> None:
    """Say, or raise, that packages were built for another Python than this one."""
    others = {name: other for name, prefix in found.items() if (other := other_python(prefix))}
    if not others:
        return
    own = f'{sys.version_info[0]}.{sys.version_info[1]}'
    built = f'built for Python {min(others.values())}, and this notebook runs Python {own}'
    compiled = [name for name in others if any(found[name].glob('lib/python3*/**/*.so'))]
    if compiled:
        raise LabError(
            f'{first_few(compiled)}: {built}. What is compiled for that one can not be loaded.',
            todo=f'Build it here: lab.build({str(workspace)!r})',
        )
    print(f'{first_few(list(others))}: {built}. Its programs are run by this one.')


def _use(prefix: Path) -> None:
    _add_first('AMENT_PREFIX_PATH', prefix)
    _add_first('LD_LIBRARY_PATH', prefix / 'lib')
    for packages in prefix.glob('lib/python3*/site-packages'):
        _add_first('PYTHONPATH', packages)
        if str(packages) not in sys.path:
            sys.path.insert(0, str(packages))
    load_libraries(sorted((prefix / 'lib').glob('lib*.so')))


def _add_first(variable: str, path: Path) -> None:
    known = [part for part in os.environ.get(variable, '').split(os.pathsep) if part]
    if str(path) not in known:
        os.environ[variable] = os.pathsep.join([str(path), *known])


def load_libraries(paths: list[Path]) -> None:
    """Load libraries by path, each after its dependencies."""
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
    """Return a hash of a built package."""
    digest = hashlib.sha256()
    for path in sorted(prefix.glob('lib/**/*')):
        if path.is_file() and path.suffix in ('.so', '.py'):
            digest.update(str(path).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def colcon(
    folder: Path,
    packages: list[str],
    *,
    label: str = 'colcon build',
    definitions: Mapping[str, str] | None = None,
) -> None:
    """Run `colcon build` in a workspace, with a progress bar.

    Args:
        folder: The workspace.
        packages: Its packages.
        label: What the bar is for.
        definitions: Further variables for CMake.

    Raises:
        LabError: It has failed.
    """
    command = [
        *(str(Path(sys.executable).parent / 'colcon'), '--log-base', 'log', 'build'),
        *('--event-handlers', 'console_direct+', '--cmake-args'),
        *(f'-DPython3_EXECUTABLE={sys.executable}', '-DBUILD_TESTING=OFF'),
        *(f'-D{name}={value}' for name, value in (definitions or {}).items()),
    ]
    bar = ProgressBar(label)
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
    except BaseException:  # e.g. the stop button
        os.killpg(process.pid, signal.SIGTERM)
        process.wait()
        raise
    finally:
        process.stdout.close()
        bar.close()
    if code:
        failed = [name for name in packages if build_result(folder, name) not in ('', '0')]
        reasons = [*_said_by_setup(folder, failed)] or [*_reasons(said)]
        raise LabError(
            f'colcon build of {", ".join(failed or packages)} has failed:\n' + '\n'.join(reasons),
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
    # An old-style `setup.py` or empy template warns, which does not concern learners.
    variables['PYTHONWARNINGS'] = 'ignore'
    return variables


def _said_by_setup(folder: Path, packages: list[str]) -> Iterator[str]:
    """Yield the last words of each setup.py that does not run: colcon leaves them out."""
    for name in packages:
        source = source_of(folder, name)
        if source is not None and setup_fails(folder, name):
            done = subprocess.run(
                [sys.executable, 'setup.py', '--name'],
                cwd=source,
                env=_variables(),
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors='replace',
            )
            yield from [f'{source / "setup.py"}:', *done.stderr.splitlines()[-SETUP_LINES:]]


def _reasons(said: list[str]) -> Iterator[str]:
    """Yield the lines of a failed build that give reasons, at most `MOST_LINES`."""
    error = re.compile(r'(?i)\berror\b|Invalid|Exception|not found')
    noise = re.compile(r'Traceback|^\s+File |Call Stack|g?make|returned error code')
    found = [line for line in said if error.search(line) and not noise.search(line)]
    yield from list(dict.fromkeys(found or said))[:MOST_LINES]
