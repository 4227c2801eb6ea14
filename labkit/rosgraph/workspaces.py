"""What colcon has left of a package in a workspace: whether it is built, and if not, why.

colcon keeps the end of each build in `build/PACKAGE/colcon_build.rc`, also where an older build of
the package stays installed; and what it said in a folder of `log` for each call.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from labkit import settings
from labkit.files import read_limited

__all__ = [
    'any_failed_build',
    'build_result',
    'failed_build',
    'other_python',
    'setup_fails',
    'source_of',
    'why_missing',
    'why_not_in',
]

# What a build fails with where setup.py itself does. What setup.py has said is in no log.
_NO_SETUP = re.compile(r'CalledProcessError: .*run_setup')
# What colcon makes in each workspace.
_MARK = Path('build', '.built_by')
# The files that say what is installed.
_LISTS = ('setup.py', 'setup.cfg', 'CMakeLists.txt')


def build_result(workspace: Path, package: str) -> str:
    """Return how the last build of a package ended: `'0'` is well, `''` is never or unknown."""
    return _text(workspace / 'build' / package / 'colcon_build.rc').strip()


def failed_build(workspace: Path, package: str) -> str:
    """Return that the last build of a package has failed and what to do, `''` if it has not."""
    result = build_result(workspace, package)
    if result in ('', '0'):
        return ''
    if result == 'SIGINT':
        return f'The last build of {package} was interrupted. Build it again: {_build(workspace)}'
    log = _log(workspace, package)
    has_failed = f'The last build of {package} has failed'
    if log is None:
        return f'{has_failed}. Build it again, and read what it says: {_build(workspace)}'
    if setup_fails(workspace, package):
        say = _build(workspace)
        if not settings.in_kernel() and (source := source_of(workspace, package)) is not None:
            say = f'cd {_shown(source)} && python3 setup.py --name'
        return f'{has_failed}: its setup.py does not run. This says why: {say}'
    return (
        f'{has_failed}. What colcon said is in {_shown(log)}. Mend that, and build it again: '
        f'{_build(workspace)}'
    )


def any_failed_build(workspace: Path) -> str:
    """Return the same of the first package whose last build has failed, `''` if none has."""
    for path in sorted((workspace / 'build').glob('*')):
        if (failed := failed_build(workspace, path.name)) and source_of(workspace, path.name):
            return failed
    return ''


def other_python(prefix: Path) -> str:
    """Return for which other Python a package is installed, such as `'3.12'`; `''` if for ours."""
    folders = sorted(path.parent.name for path in prefix.glob('lib/python3*/site-packages'))
    versions = [name.removeprefix('python') for name in folders]
    own = f'{sys.version_info[0]}.{sys.version_info[1]}'
    return versions[0] if versions and own not in versions else ''


def setup_fails(workspace: Path, package: str) -> bool:
    """Return whether the last build of a package got no further than to run its setup.py."""
    log = _log(workspace, package)
    return log is not None and _NO_SETUP.search(_text(log)) is not None


def source_of(workspace: Path, package: str) -> Path | None:
    """Return the folder of the source of a package, None if there is none of its name."""
    files = (workspace / 'src').rglob(f'{package}/package.xml') if _is_name(package) else ()
    return next((path.parent for path in files), None)


def why_missing(package: str) -> str:
    """Return what is known of a package that this process does not find, `''` if nothing is."""
    for workspace in _workspaces() if _is_name(package) else ():
        if failed := failed_build(workspace, package):
            return failed
        place = 'this folder' if workspace == _here() else str(workspace)
        install = workspace / 'install'
        marker = Path('share', 'ament_index', 'resource_index', 'packages', package)
        if (install / package / marker).is_file() or (install / marker).is_file():
            if settings.in_kernel():
                who, todo = 'notebook', f'lab.source({_shown(workspace)!r})'
            else:
                who, todo = 'terminal', f'source {_shown(install / "setup.bash")}'
            return f'It is built in {place}, but this {who} does not know it yet: {todo}'
        if source := source_of(workspace, package):
            todo = any_failed_build(workspace) or f'Build it: {_build(workspace)}'
            return f'Its source is in {_shown(source)}, and it is not built. {todo}'
    return ''


def why_not_in(package: str, prefix: Path) -> str:
    """Return why a package that is installed may lack something, `''` if no reason is seen.

    Args:
        package: Its name.
        prefix: Where it is installed.
    """
    built = (folder for folder in prefix.parents if build_result(folder, package))
    workspace = next(built, None)
    if workspace is None:
        return ''
    if failed := failed_build(workspace, package):
        return failed
    ended = (workspace / 'build' / package / 'colcon_build.rc').stat().st_mtime
    source = source_of(workspace, package)
    for file in (source / name for name in _LISTS) if source else ():
        if file.is_file() and file.stat().st_mtime > ended:
            return f'{_shown(file)} was changed after the last build: {_build(workspace)}'
    return ''


def _workspaces() -> Iterator[Path]:
    """Yield this folder, and the workspaces around it, in it, and sourced by this process."""
    here = _here()
    yield here
    found = [*here.parents, *(path.parents[1] for path in sorted(here.glob(f'*/{_MARK}')))]
    for variable in ('COLCON_PREFIX_PATH', 'AMENT_PREFIX_PATH'):
        for part in filter(None, os.environ.get(variable, '').split(os.pathsep)):
            found += [path.parent for path in [Path(part), *Path(part).parents][:2]]
    for folder in dict.fromkeys(found):
        if folder != here and (folder / _MARK).is_file():
            yield folder


def _log(workspace: Path, package: str) -> Path | None:
    """Return the file with what the last build of a package said."""
    logs = workspace / 'log'
    folders = sorted(path.parent for path in logs.glob(f'build_*/{package}'))
    if not folders:
        return None
    latest = logs / 'latest_build'
    folder = (latest if latest.resolve() == folders[-1].resolve() else folders[-1]) / package
    errors = folder / 'stderr.log'
    return errors if _text(errors).strip() else folder / 'stdout_stderr.log'


def _build(workspace: Path) -> str:
    """Return how a workspace is built, from here."""
    if settings.in_kernel():
        return f'lab.build({_shown(workspace)!r})'
    return 'colcon build' if workspace == _here() else f'cd {workspace} && colcon build'


def _shown(path: Path) -> str:
    """Return a path as it is written from here."""
    here = _here()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)


def _here() -> Path:
    try:
        return Path.cwd()
    except FileNotFoundError:  # somebody has deleted it
        return Path(os.sep)


def _is_name(package: str) -> bool:
    return re.fullmatch(r'\w[\w-]*', package) is not None


def _text(path: Path) -> str:
    try:
        return read_limited(path).decode(errors='replace')
    except OSError:
        return ''
