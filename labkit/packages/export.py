"""`lab.export`: a node class of a notebook becomes a package that runs without the notebook."""

from __future__ import annotations

import ast
import inspect
import re
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from labkit.errors import LabError, first_few
from labkit.packages.cells import Definition, Notebook
from labkit.packages.gather import Gathered, gather
from labkit.packages.skeleton import Part, Skeleton, check_name, license_text, own_email, own_name

__all__ = ['Exported', 'export']

# Modules that are no packages of ROS, and the names under which ROS knows what they come with
# (rosdep's list for Python).
_ROSDEP = {
    'cv2': 'python3-opencv',
    'matplotlib': 'python3-matplotlib',
    'numpy': 'python3-numpy',
    'PIL': 'python3-pil',
    'psutil': 'python3-psutil',
    'requests': 'python3-requests',
    'scipy': 'python3-scipy',
    'serial': 'python3-serial',
    'yaml': 'python3-yaml',
}
_MODULE = '''\
"""{summary}"""

{imports}
{definitions}


def main(args=None):
    """Run the node until it is interrupted."""
    rclpy.init(args=args)
    node = {name}()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
'''
_TEST = '''\
"""The node {name} can be made, and has its name."""

import rclpy

from {package}.{module} import {name}


def test_{module}_can_be_made():
    rclpy.init()
    try:
        node = {name}()
        assert {claim}
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
'''


@dataclass(frozen=True)
class Exported:
    """A package that was made of node classes.

    Attributes:
        package: Its name.
        folder: Its folder.
        files: Its files, as paths from that folder on.
        executables: What `ros2 run` can start in it.
        dependencies: What package.xml says that it needs.
        unnamed: Modules that it imports and that package.xml does not name, since labkit does
            not know in which package they come.
    """

    package: str
    folder: Path
    files: Sequence[str]
    executables: Sequence[str]
    dependencies: Sequence[str]
    unnamed: Sequence[str] = ()

    def __repr__(self) -> str:
        lines = [f'Package {self.package} in {self.folder}']
        lines += [f'  {name}' for name in self.files]
        lines += [f'It depends on: {", ".join(self.dependencies)}']
        if self.unnamed:
            lines += [f'Add to package.xml what brings: {", ".join(self.unnamed)}']
        lines += ['When it is built and sourced:']
        lines += [f'  ros2 run {self.package} {name}' for name in self.executables]
        return '\n'.join(lines)


def export(
    *node_classes: type,
    package: str,
    folder: str | Path = '.',
    description: str = '',
    license: str = 'Apache-2.0',
    maintainer_name: str = '',
    maintainer_email: str = '',
    overwrite: bool = False,
) -> Exported:
    """Make a package of ROS 2 from node classes of this notebook.

    Each class becomes a module with a `main()` and an entry in setup.py, and gets a test. What it
    uses of the notebook (imports, constants, functions, base classes) comes along. The package
    needs neither labkit nor the notebook: `colcon build` builds it on any machine with ROS 2.

    Args:
        node_classes: One or more classes on `rclpy.node.Node` that can be made without arguments.
        package: Name of the package, in small letters, digits and underscores.
        folder: Where the folder of the package is made, such as the `src` of a workspace.
        description: A sentence on what it does; made from the names of the classes if empty.
        license: An SPDX identifier, or any other text.
        maintainer_name: Who looks after it; the user of this computer if empty.
        maintainer_email: Their address; that of git, or a placeholder, if empty.
        overwrite: Whether to replace a package of that name that is there.

    Returns:
        What was made.

    Raises:
        LabError: A class leans on something that can not come along, or the folder is taken.
    """
    check_name(package)
    modules = _modules(node_classes)
    sources = {name: _module_text(made, package) for name, made in modules.items()}
    dependencies, unnamed = _dependencies(sources.values())
    maintainer = maintainer_name or own_name()
    names = ' and '.join(made.__name__ for made in node_classes)
    skeleton = Skeleton(
        name=package,
        maintainer=maintainer,
        email=maintainer_email or own_email(maintainer),
        description=description or f'The node{"s" * (len(modules) > 1)} {names}',
        license=license,
        dependencies=dependencies,
        test_dependencies=['python3-pytest'],
        scripts=[(name, f'{package}.{name}:main') for name in modules],
    )
    parts = _parts(skeleton, modules, sources)
    target = Path(folder) / package
    _make(parts, target, overwrite=overwrite)
    files = sorted(part.path for part in parts if part.text is not None)
    return Exported(package, target, files, list(modules), dependencies, unnamed)


def _parts(
    skeleton: Skeleton, modules: Mapping[str, type], sources: Mapping[str, str]
) -> list[Part]:
    """Return all files and folders of the package."""
    package = skeleton.name
    parts = [
        *skeleton.parts(),
        *(Part(f'{package}/{name}.py', text) for name, text in sources.items()),
        *(_test(name, made, package) for name, made in modules.items()),
    ]
    text = license_text(skeleton.license)
    return parts if text is None else [*parts, Part('LICENSE', text)]


def _modules(node_classes: Sequence[type]) -> dict[str, type]:
    """Return the classes by the names of their modules.

    Raises:
        LabError: One of them is no class of a node, or can not be made without arguments.
    """
    from rclpy.node import Node

    if not node_classes:
        raise LabError('Which class?', todo="lab.export(Talker, package='my_package')")
    found: dict[str, type] = {}
    for made in node_classes:
        if isinstance(made, Node):
            name = type(made).__name__
            raise LabError(
                f'lab.export takes the class, and {name}() is one of its nodes.',
                todo=f'Write {name} without brackets, and without lab.spin.',
            )
        if not (inspect.isclass(made) and issubclass(made, Node)):
            raise LabError(
                f'lab.export takes classes of nodes, and this is {made!r}.',
                todo='Write a class that begins with: class Talker(Node):',
            )
        if made.__module__.partition('.')[0] == 'labkit':
            raise LabError(
                f'{made.__name__} belongs to labkit, the helper of this notebook.',
                todo='Export a class of your own, that uses rclpy alone.',
            )
        if '<locals>' in made.__qualname__ or made.__name__ != made.__qualname__:
            raise LabError(
                f'{made.__name__} is defined inside of {made.__qualname__.split(".")[0]}.',
                todo='Write the class at the beginning of a line, in a cell.',
            )
        _refuse_arguments(made)
        name = re.sub(r'(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])', '_', made.__name__)
        name = name.lower()
        if name in found and found[name] is not made:
            raise LabError(f'Two of the classes would both become {name}.py.')
        found[name] = made
    return found


def _refuse_arguments(made: type) -> None:
    """Raise a LabError if a class can not be made without arguments: `ros2 run` has none."""
    needed = [
        one.name
        for one in inspect.signature(made).parameters.values()
        if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
    ]
    if needed:
        raise LabError(
            f'{made.__name__}() needs {first_few(needed)}, and `ros2 run` gives it nothing.',
            todo=f'Give each a value to begin with, as in __init__(self, {needed[0]}=...), or '
            'make it a parameter of the node.',
        )


def _module_text(made: type, package: str) -> str:
    gathered = gather(made, Notebook.of(made))
    summary = (inspect.cleandoc(made.__doc__ or '').partition('\n')[0]) or (
        f'The node {made.__name__} of the package {package}.'
    )
    if made.__doc__ == getattr(made.__base__, '__doc__', None):
        summary = f'The node {made.__name__} of the package {package}.'
    needed = {'import rclpy', 'from rclpy.executors import ExternalShutdownException'}
    groups = _groups(gathered)
    short = _is_short(gathered.definitions[0])
    return _MODULE.format(
        summary=summary.replace('\\', '\\\\').replace('"', "'"),
        imports=_import_lines(gathered.imports | needed, annotations=gathered.annotations),
        definitions='\n' * (1 if short else 2) + '\n\n\n'.join(groups),
        name=made.__name__,
    )


def _groups(gathered: Gathered) -> list[str]:
    """Return the statements; constants that follow each other stand together."""
    groups: list[str] = []
    last_short = False
    for definition in gathered.definitions:
        short = _is_short(definition)
        if short and last_short:
            groups[-1] += f'\n{definition.text}'
        else:
            groups.append(definition.text)
        last_short = short
    return groups


def _is_short(definition: Definition) -> bool:
    return isinstance(definition.node, (ast.Assign, ast.AnnAssign))


def _import_lines(imports: set[str], *, annotations: bool) -> str:
    """Return import statements in the order of PEP 8: the standard library, then the others."""
    groups: list[list[str]] = [[], []]
    for statement in imports:
        groups[_top(statement) not in sys.stdlib_module_names].append(statement)

    def key(statement: str) -> tuple[str, str]:
        return statement.split()[1], statement

    blocks = ['from __future__ import annotations'] if annotations else []
    blocks += ['\n'.join(_joined(sorted(group, key=key))) for group in groups if group]
    return '\n\n'.join(blocks)


def _joined(statements: Sequence[str]) -> list[str]:
    """Put names that come from one module into one statement."""
    result: list[str] = []
    for statement in statements:
        start, _, name = statement.partition(' import ')
        if result and name and result[-1].startswith(f'{start} import '):
            joined = f'{result[-1]}, {name}'
            if len(joined) < 80:
                result[-1] = joined
                continue
        result.append(statement)
    return result


def _top(statement: str) -> str:
    return statement.split()[1].partition('.')[0]


def _dependencies(sources: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return what package.xml has to name, and the modules that it can not name."""
    from labkit.rosgraph.packages import package_names

    modules: set[str] = set()
    for source in sources:
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Import):
                modules |= {alias.name.partition('.')[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                modules.add(node.module.partition('.')[0])
    others = sorted(modules - set(sys.stdlib_module_names))
    known = set(package_names())
    named = [_ROSDEP.get(name, name) for name in others if name in known or name in _ROSDEP]
    return named, [name for name in others if name not in known and name not in _ROSDEP]


def _test(module: str, made: type, package: str) -> Part:
    node_name = _literal_name(made)
    claim = f'node.get_name() == {node_name!r}' if node_name else 'node.get_name()'
    text = _TEST.format(name=made.__name__, package=package, module=module, claim=claim)
    return Part(f'test/test_{module}.py', text)


def _literal_name(made: type) -> str:
    """Return the name that a class gives its nodes, `''` if only a run could tell."""
    definition = Notebook.of(made).find(made.__name__)
    for node in ast.walk(definition.node) if definition is not None else ():
        if isinstance(node, ast.Call) and ast.unparse(node.func) == 'super().__init__':
            first = node.args[0] if node.args else None
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                return first.value
    return ''


def _make(parts: Sequence[Part], target: Path, *, overwrite: bool) -> None:
    """Make the files of a package, in the place of an earlier one if that is allowed.

    Raises:
        LabError: The folder is taken, or can't be written.
    """
    if target.exists() or target.is_symlink():
        if not overwrite:
            raise LabError(
                f'{target} is there already.',
                todo='overwrite=True replaces it, with all that you have changed in it.',
            )
        if not _is_package(target):
            raise LabError(
                f'{target} is there, and is no package of that name: it is not overwritten.',
                todo='Take another name, or another folder.',
            )
    try:
        if target.exists():
            shutil.rmtree(target)
        for part in parts:
            part.write(target)
    except OSError as error:
        raise LabError(f'{error.filename} can not be made: {error.strerror}.') from error


def _is_package(target: Path) -> bool:
    """Tell whether a folder is a package of the name that the folder has."""
    path = target / 'package.xml'
    try:
        return not target.is_symlink() and f'<name>{target.name}</name>' in path.read_text()
    except (OSError, UnicodeDecodeError):
        return False
