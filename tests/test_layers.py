"""Imports in labkit only go down its layers: read off the code, wherever in it they stand."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

# The layer of every module; `labkit.views.*` stands for all modules of a folder and the folder.
LAYERS = {
    'labkit.errors': 0,
    'labkit.background.supervisor': 0,
    'labkit.settings': 0,
    'labkit.sim': 0,
    'labkit.sim.kinematics': 0,
    'labkit.sim.simulator': 0,
    'labkit.sim.world': 0,
    'labkit.background.console': 1,
    'labkit.background.executor': 1,
    'labkit.background.nodes': 1,
    'labkit.background.notebook_rclpy': 1,
    'labkit.background.runtime': 1,
    'labkit.rosgraph.matching': 1,
    'labkit.background.tracebacks': 1,
    'labkit.bag': 2,
    'labkit.rosgraph.snapshot': 2,
    'labkit.background.child_processes': 2,
    'labkit.background': 0,
    'labkit.background.demo_nodes': 2,
    'labkit.background.discovery': 2,
    'labkit.background.program': 2,
    'labkit.background.service_calls': 2,
    'labkit.course': 5,
    'labkit.rosgraph': 0,
    'labkit.rosgraph.interfaces': 2,
    'labkit.rosgraph.message_yaml': 2,
    'labkit.rosgraph.packages': 2,
    'labkit.rosgraph.whose': 3,
    'labkit.setup': 0,
    'labkit.ros2.*': 2,
    'labkit.sim.messages': 2,
    'labkit.sim.turtlebot': 2,
    'labkit.background.waiting': 2,
    'labkit.exercises.*': 3,
    'labkit.views.*': 3,
    'labkit.lessons.*': 4,
    'labkit': 5,
    'labkit.__main__': 5,
    'labkit.checkup.*': 5,
    'labkit.checkup.report': 5,
    'labkit.setup.installer': 5,
    'labkit.course.learner_folder': 5,
    'labkit.course.lesson_run': 5,
    'labkit.setup.machine': 5,
    'labkit.course.record': 5,
    'labkit.course.run_tests': 5,
    'labkit.setup.environment': 5,
}
ROS_LAYERS = (1, 2)
VIEWS_ONLY = ('anywidget', 'ipywidgets', 'matplotlib')
# What `python3 -m labkit` needs before there is an environment.
BARE = (
    *('labkit', 'labkit.__main__', 'labkit.checkup.report', 'labkit.errors', 'labkit.settings'),
    *('labkit.setup.installer', 'labkit.course.learner_folder', 'labkit.setup.machine'),
    *('labkit.course.run_tests', 'labkit.setup.environment'),
)


@dataclass(frozen=True)
class Import:
    """An import of one module: where it stands, and whether it is done when the file is loaded."""

    target: str
    line: int
    at_load: bool
    for_types: bool = False


def layer_of(module: str) -> int | None:
    """Return a module's layer, None if the table does not have it."""
    if module in LAYERS:
        return LAYERS[module]
    parts = module.split('.')
    starred = ('.'.join(parts[:end]) + '.*' for end in range(len(parts), 1, -1))
    return next((LAYERS[name] for name in starred if name in LAYERS), None)


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
            yield inner if layer_of(inner) is not None else str(node.module)
    elif isinstance(node, ast.Call) and called(node) in ('import_module', '__import__'):
        yield computed_name(node.args[0])


def computed_name(argument: ast.expr) -> str:
    """Return the name that `import_module` gets, with `'?'` for what only a run can tell."""
    if isinstance(argument, ast.Constant):
        return str(argument.value)
    if isinstance(argument, ast.JoinedStr):
        return ''.join(map(computed_name, argument.values))
    # A package of messages may be computed; one of labkit's own modules only in the top layer.
    ours = {'labkit', '__name__', '__package__'}
    return 'labkit?' if any(word in ast.unparse(argument) for word in ours) else '?'


def called(node: ast.Call) -> str:
    """Return the last part of the name of what is called."""
    return getattr(node.func, 'attr', '') or getattr(node.func, 'id', '')


def violations(module: str, source: str) -> list[str]:
    """Return a sentence for each import in a module that the layers forbid."""
    layer = layer_of(module)
    if layer is None:
        return [f'{module} is in no layer: add it to LAYERS, and to DESIGN if it is a new idea']
    found = [problem(module, layer, imported) for imported in imports(ast.parse(source))]
    return [sentence for sentence in found if sentence]


def problem(module: str, layer: int, imported: Import) -> str:
    """Return what is wrong with one import, `''` if it is in order."""
    target, place = imported.target, f'{module}, line {imported.line}'
    package = target.partition('.')[0]
    if package in ('labkit', 'labkit?'):
        below = layer_of(target)
        if below is None:
            return f'{place}: imports {target}, which is in no layer'
        if below > layer:
            return f'{place}: layer {layer} imports {target} of layer {below}; import downwards'
    if package == 'rclpy' and not imported.for_types:
        if layer == 0:
            return f'{place}: layer 0 knows nothing of rclpy'
        if imported.at_load and layer not in ROS_LAYERS:
            return f'{place}: import rclpy inside the function that needs it'
    if package in VIEWS_ONLY and not module.startswith('labkit.views'):
        return f'{place}: only labkit.views imports {package}'
    return ''


def modules() -> dict[str, str]:
    """Return the source of every module of labkit, by its name."""
    result = {}
    for path in sorted((ROOT / 'labkit').rglob('*.py')):
        parts = path.relative_to(ROOT).with_suffix('').parts
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


def cycle_graph(sources: dict[str, str]) -> dict[str, set[str]]:
    """Return which modules of labkit each one imports when it is loaded."""
    return {
        name: {
            imported.target
            for imported in imports(ast.parse(source))
            if imported.at_load and not imported.for_types and imported.target in sources
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


@pytest.mark.parametrize(
    ('module', 'source', 'words'),
    [
        ('labkit.unheard_of', '', 'in no layer'),
        ('labkit.background.runtime', 'from labkit.unheard_of import x', 'in no layer'),
        (
            'labkit.background.runtime',
            'from labkit.background.waiting import wait_until',
            'layer 1 imports',
        ),
        (
            'labkit.background.runtime',
            'from labkit.background import waiting',
            'waiting of layer 2',
        ),
        (
            'labkit.background.runtime',
            'def f():\n    import labkit.views.plot',
            'line 2: layer 1 imports',
        ),
        (
            'labkit.background.runtime',
            'if TYPE_CHECKING:\n    import labkit.rosgraph.snapshot',
            'layer 1 imports',
        ),
        ('labkit.lessons.odds', 'import labkit as lab', 'labkit of layer 5'),
        ('labkit.lessons.odds', 'from labkit import spin', 'labkit of layer 5'),
        (
            'labkit.rosgraph.snapshot',
            "importlib.import_module('labkit.views.x')",
            'layer 2 imports',
        ),
        ('labkit.exercises.x', "import_module(f'labkit.lessons.{name}')", 'layer 3 imports'),
        ('labkit.exercises.x', "import_module('labkit.' + name)", 'in no layer'),
        ('labkit.sim.world', 'def f():\n    import rclpy', 'nothing of rclpy'),
        ('labkit.views.graph', 'import rclpy.node', 'inside the function'),
        ('labkit.views.graph', 'class A:\n    from rclpy.qos import QoSProfile', 'inside the'),
        ('labkit.lessons.odds', 'try:\n    import rclpy\nfinally:\n    pass', 'inside the'),
        (
            'labkit.rosgraph.snapshot',
            'def f():\n    import ipywidgets',
            'only labkit.views imports',
        ),
        ('labkit.checkup.report', 'from matplotlib import pyplot', 'only labkit.views imports'),
    ],
)
def test_a_forbidden_import_would_be_found(module: str, source: str, words: str):
    assert [words in line for line in violations(module, source)] == [True]


@pytest.mark.parametrize(
    ('module', 'source'),
    [
        ('labkit.background.runtime', 'import rclpy\nfrom labkit import settings\nimport json'),
        ('labkit.views.plot', 'import matplotlib\ndef f():\n    import rclpy'),
        ('labkit.views.plot', 'if TYPE_CHECKING:\n    from rclpy.node import Node'),
        ('labkit', 'importlib.import_module(name)'),
        ('labkit.rosgraph.snapshot', "import_module(f'{package}.msg')"),
        ('labkit.course.record', 'from labkit import __version__'),
        ('labkit.ros2.topic', 'from labkit.ros2.parser import verbs'),
    ],
)
def test_an_allowed_import_is_let_pass(module: str, source: str):
    assert violations(module, source) == []


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
