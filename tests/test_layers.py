"""Imports in labkit only go down its floors: read off the code, wherever in it they stand."""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parent.parent

# The floor of every room, and of the modules that lie beside them; see docs/design.md.
FLOORS = {
    'labkit.errors': 0,
    'labkit.domain_ids': 0.1,
    'labkit.files': 0.1,
    'labkit.stop_button': 0.1,
    'labkit.settings': 0.2,
    'labkit.progress_bar': 0.3,
    'labkit.setup': 1,
    'labkit.rosgraph': 1,
    'labkit.background': 2,
    'labkit.asking': 2.1,
    'labkit.transforms': 2.1,
    'labkit.descriptions': 2.15,
    'labkit.programs': 2.2,
    'labkit.sharing': 2.3,
    'labkit.silent': 2.4,
    'labkit.bags': 3,
    'labkit.packages': 3,
    'labkit.launching': 3.1,
    'labkit.ros2': 4,
    'labkit.sim': 4,
    'labkit.checkup': 4,
    'labkit.views': 5,
    'labkit.exercises': 6,
    'labkit.lessons': 7,
    'labkit.course': 8,
    'labkit.teaching': 8,
    'labkit.hub': 8.1,
    'labkit': 9,
    'labkit.__main__': 9.1,
}
# Rooms, and one module, in which all that is loaded may need rclpy.
WITH_ROS = (
    *('labkit.rosgraph', 'labkit.background', 'labkit.asking', 'labkit.programs'),
    *('labkit.sharing', 'labkit.bags', 'labkit.transforms', 'labkit.sim.turtlebot'),
    *('labkit.silent.reading', 'labkit.silent.watch'),
)
WITHOUT_ROS = (
    *('labkit.domain_ids', 'labkit.errors', 'labkit.files', 'labkit.settings', 'labkit.setup'),
    'labkit.stop_button',
)
VIEWS_ONLY = ('anywidget', 'ipywidgets', 'matplotlib', 'pygments', 'sidecar')
# What `python3 -m labkit` needs before there is an environment.
BARE = (
    *('labkit', 'labkit.__main__', 'labkit.checkup.report', 'labkit.errors', 'labkit.settings'),
    *('labkit.domain_ids', 'labkit.files', 'labkit.stop_button'),
    *('labkit.setup.environment', 'labkit.setup.installer'),
    *('labkit.setup.machine', 'labkit.setup.requirements', 'labkit.course.jupyterlab'),
    *('labkit.course.learner_folder', 'labkit.course.run_tests', 'labkit.hub.command'),
)


@dataclass(frozen=True)
class Import:
    """An import of one module: where it stands, and whether it is done when the file is loaded."""

    target: str
    line: int
    at_load: bool
    for_types: bool = False


def room_of(module: str) -> str | None:
    """Return the room of a module, None if the table does not have it."""
    room = '.'.join(module.split('.')[:2])
    return room if room in FLOORS else None


def imports(tree: ast.AST, *, at_load: bool = True, for_types: bool = False) -> Iterator[Import]:
    """Find all imports in a piece of code, `import_module` calls included."""
    for node in ast.iter_child_nodes(tree):
        in_function = isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
        typing = isinstance(node, ast.If) and 'TYPE_CHECKING' in ast.dump(node.test)
        yield from (Import(target, node.lineno, at_load, for_types) for target in targets(node))
        yield from imports(
            node, at_load=at_load and not in_function, for_types=for_types or typing
        )


def targets(node: ast.AST) -> Iterator[str]:
    """Return the modules that one statement or call imports."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        assert node.level == 0, f'line {node.lineno}: write the whole name of the module'
        for alias in node.names:
            inner = f'{node.module}.{alias.name}'
            # `from labkit import settings` takes a module, `from labkit import spin` a name.
            yield inner if is_module(inner) else str(node.module)
    elif isinstance(node, ast.Call) and called(node) in ('import_module', '__import__'):
        yield computed_name(node.args[0])


def is_module(name: str) -> bool:
    """Tell whether a name is that of a module or a package of this repository."""
    path = ROOT.joinpath(*name.split('.'))
    return path.is_dir() or path.with_suffix('.py').is_file()


def computed_name(argument: ast.expr) -> str:
    """Return the name that `import_module` gets, with `'?'` for what only a run can tell."""
    if isinstance(argument, ast.Constant):
        return str(argument.value)
    if isinstance(argument, ast.JoinedStr):
        return ''.join(map(computed_name, argument.values))
    # A package of messages may be computed; one of labkit's own modules only at the top.
    ours = {'labkit', '__name__', '__package__'}
    return 'labkit?' if any(word in ast.unparse(argument) for word in ours) else '?'


def called(node: ast.Call) -> str:
    """Return the last part of the name of what is called."""
    return getattr(node.func, 'attr', '') or getattr(node.func, 'id', '')


def violations(module: str, source: str) -> list[str]:
    """Return a sentence for each import in a module that the floors forbid."""
    room = room_of(module)
    if room is None:
        return [f'{module} is in no room: add it to FLOORS, and to docs/design.md']
    found = [problem(module, room, imported) for imported in imports(ast.parse(source))]
    return [sentence for sentence in found if sentence]


def problem(module: str, room: str, imported: Import) -> str:
    """Return what is wrong with one import, `''` if it is in order."""
    target, place = imported.target, f'{module}, line {imported.line}'
    package = target.partition('.')[0]
    if package in ('labkit', 'labkit?'):
        other = room_of(target)
        if other is None:
            return f'{place}: imports {target}, which is in no room'
        if other != room and FLOORS[other] >= FLOORS[room]:
            return f'{place}: {room} imports {target}, which is not below it'
    if package == 'rclpy' and not imported.for_types:
        if room in WITHOUT_ROS:
            return f'{place}: {room} knows nothing of rclpy'
        if imported.at_load and not module.startswith(WITH_ROS):
            return f'{place}: import rclpy inside the function that needs it'
    if package in VIEWS_ONLY and room != 'labkit.views':
        return f'{place}: only labkit.views imports {package}'
    return ''


def modules() -> dict[str, str]:
    """Return the source of every module of labkit, by its name."""
    result = {}
    for path in sorted((ROOT / 'labkit').rglob('*.py')):
        parts = path.relative_to(ROOT).with_suffix('').parts
        if parts[-2] == 'solutions' or parts[1] == 'data':
            continue  # cells of a notebook, and settings: nothing imports them
        name = '.'.join(parts).removesuffix('.__init__')
        result[name] = path.read_text(encoding='utf-8')
    return result


def test_imports_only_go_down():
    found = [line for name, source in modules().items() for line in violations(name, source)]
    assert not found, '\n'.join(found)


def test_no_module_needs_itself_to_load():
    graph = cycle_graph(modules())
    assert graph, 'no module found'
    TopologicalSorter(graph).prepare()


# Rooms whose modules import one way, also inside functions.
ONE_WAY = ('labkit.launching',)


@pytest.mark.parametrize('room', ONE_WAY)
def test_imports_in_a_room_go_one_way(room: str):
    graph = cycle_graph({name: source for name, source in modules().items() if room in name}, room)
    assert graph, 'no module found'
    TopologicalSorter(graph).prepare()


def cycle_graph(sources: dict[str, str], room: str = '-') -> dict[str, set[str]]:
    """Return which modules of labkit each one imports when it is loaded; in a room, ever."""
    return {
        name: {
            imported.target
            for imported in imports(ast.parse(source))
            if imported.target in sources
            and not imported.for_types
            and (imported.at_load or room_of(name) == room)
        }
        for name, source in sources.items()
    }


def test_a_cycle_would_be_found():
    sources = {
        'labkit.background.runtime': 'from labkit.background import console',
        'labkit.background.console': 'from labkit.background.runtime import start',
    }
    with pytest.raises(CycleError):
        TopologicalSorter(cycle_graph(sources)).prepare()
    sources['labkit.background.console'] = (
        'def f():\n    from labkit.background.runtime import start'
    )
    TopologicalSorter(cycle_graph(sources)).prepare()
    with pytest.raises(CycleError):
        TopologicalSorter(cycle_graph(sources, 'labkit.background')).prepare()


@pytest.mark.parametrize(
    ('module', 'source', 'words'),
    [
        ('labkit.unheard_of', '', 'in no room'),
        ('labkit.background.x', 'from labkit.unheard_of import x', 'in no room'),
        ('labkit.background.x', 'from labkit.views.plot import plot', 'not below it'),
        ('labkit.background.x', 'def f():\n    import labkit.views.plot', 'line 2: labkit.backgr'),
        ('labkit.background.x', 'if TYPE_CHECKING:\n    import labkit.views', 'not below it'),
        ('labkit.ros2.x', 'from labkit.sim import world', 'labkit.sim.world, which is not'),
        ('labkit.setup.x', 'from labkit import __version__', 'not below it'),
        ('labkit.lessons.odds', 'import labkit as lab', 'not below it'),
        ('labkit.lessons.odds', 'from labkit import spin', 'imports labkit, which'),
        ('labkit.rosgraph.x', "importlib.import_module('labkit.views.x')", 'not below it'),
        ('labkit.exercises.x', "import_module(f'labkit.lessons.{name}')", 'not below it'),
        ('labkit.exercises.x', "import_module('labkit.' + name)", 'in no room'),
        ('labkit.setup.x', 'def f():\n    import rclpy', 'nothing of rclpy'),
        ('labkit.views.graph', 'import rclpy.node', 'inside the function'),
        ('labkit.ros2.x', 'from rclpy.node import Node', 'inside the function'),
        ('labkit.views.graph', 'class A:\n    from rclpy.qos import QoSProfile', 'inside the'),
        ('labkit.lessons.odds', 'try:\n    import rclpy\nfinally:\n    pass', 'inside the'),
        ('labkit.rosgraph.x', 'def f():\n    import ipywidgets', 'only labkit.views imports'),
        ('labkit.checkup.x', 'from matplotlib import pyplot', 'only labkit.views imports'),
    ],
)
def test_a_forbidden_import_would_be_found(module: str, source: str, words: str):
    assert [words in line for line in violations(module, source)] == [True]


@pytest.mark.parametrize(
    ('module', 'source'),
    [
        ('labkit.background.x', 'import rclpy\nfrom labkit import settings\nimport json'),
        ('labkit.background.x', 'from labkit.rosgraph.names import is_hidden'),
        ('labkit.sim.turtlebot', 'import rclpy\nfrom labkit.sim.world import World'),
        ('labkit.views.plot', 'import matplotlib\ndef f():\n    import rclpy'),
        ('labkit.views.plot', 'if TYPE_CHECKING:\n    from rclpy.node import Node'),
        ('labkit', 'importlib.import_module(name)'),
        ('labkit.rosgraph.x', "import_module(f'{package}.msg')"),
        ('labkit.ros2.topic', 'from labkit.ros2.parser import Verb'),
    ],
)
def test_an_allowed_import_is_let_pass(module: str, source: str):
    assert violations(module, source) == []


def test_no_room_has_the_name_of_a_public_function():
    import labkit

    rooms = {name.partition('.')[2].partition('.')[0] for name in modules()}
    assert rooms & set(labkit.__all__) == set()


# Prints what an import has loaded that comes neither with Python nor with labkit.
PROBE = """
import importlib, sys
before = set(sys.modules)
importlib.import_module({module!r})
known = {{*sys.stdlib_module_names, 'labkit'}}
print(sorted(name for name in set(sys.modules) - before if name.partition('.')[0] not in known))
"""


@pytest.mark.parametrize('module', [name for name in BARE if name in modules()])
def test_works_with_nothing_installed(module: str, tmp_path: Path):
    code = f'import sys\nsys.path.insert(0, {str(ROOT)!r})\n' + PROBE.format(module=module)
    # No environment variables, no site-packages, no files that run at start.
    command = [sys.executable, '-I', '-S', '-c', code]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, '[]\n'), done.stderr


def test_import_is_light_where_everything_is_installed(script):
    result = script(PROBE.format(module='labkit'))
    assert (result.exit_code, result.stdout) == (0, '[]\n'), result.stderr


def test_bare_python_really_has_nothing():
    command = [sys.executable, '-I', '-S', '-c', 'import rclpy']
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert 'ModuleNotFoundError' in done.stderr


def test_the_floors_are_those_of_the_design():
    design = (ROOT / 'docs' / 'design.md').read_text(encoding='utf-8')
    told = {
        f'labkit.{name}': float(floor)
        for floor, names in re.findall(r'^\| ([\d.]+) \| (.*?) \|', design, re.MULTILINE)
        for name in re.findall(r'`(\w+)/`', names)
    }
    folders = {name for name in FLOORS if (ROOT / name.replace('.', '/')).is_dir()}
    assert told == {name: FLOORS[name] for name in folders - {'labkit'}}


# A name in two rooms sends half of its readers to the wrong one. What is called as the notebook
# calls it (an exercise, a quiz) is found by its lesson.
MOST_TWICE = 8


def test_few_names_stand_in_two_rooms():
    rooms: dict[str, set[str]] = {}
    for name, source in modules().items():
        room, _, base = name.rpartition('.')
        of_notebook = '.lessons.' in name and (base == 'quiz' or exercise_in(source))
        if room and not of_notebook and not (ROOT / name.replace('.', '/')).is_dir():
            rooms.setdefault(base, set()).add(room)
    rooms.pop('__main__')
    twice = {base: sorted(found) for base, found in rooms.items() if len(found) > 1}
    assert 0 < len(twice) <= MOST_TWICE, twice


def exercise_in(source: str) -> bool:
    """Tell whether a module makes an exercise, under the name that all of them have."""
    return 'exercise' in defined(source)


def defined(source: str) -> set[str]:
    """Return the names that a module defines when it is loaded."""
    return {
        getattr(target, 'id', getattr(target, 'name', ''))
        for node in ast.parse(source).body
        for target in getattr(node, 'targets', [getattr(node, 'target', node)])
    }


def test_every_module_says_its_subject_first():
    silent = [
        name
        for name, source in modules().items()
        if not re.match(r'.+[.:?](\n|$)', ast.get_docstring(ast.parse(source)) or '')
    ]
    assert silent == []


def test_an_exercise_does_not_hide_its_module():
    hidden = [
        name
        for name, source in modules().items()
        if '.lessons.' in name and name.rpartition('.')[2] in defined(source)
    ]
    assert hidden == []
    assert isinstance(importlib.import_module('labkit.lessons.odds.evens'), ModuleType)
