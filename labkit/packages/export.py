"""`lab.export`: turn a node class of a notebook into a package that runs without it."""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from labkit.errors import LabError, first_few, quoted
from labkit.files import read_limited, replaced
from labkit.packages.cells import Definition, Notebook
from labkit.packages.fresh import lacking_imports
from labkit.packages.gather import Gathered, gather
from labkit.packages.skeleton import Part, Skeleton, check_name, license_text, own_email, own_name

__all__ = ['Exported', 'export']

# Modules that are not ROS packages, and the rosdep keys of the packages that provide them.
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
    """A package made from node classes.

    Attributes:
        files: Its files, relative to that folder.
        executables: Its executables for `ros2 run`.
        dependencies: Its dependencies in package.xml.
        unnamed: Imported modules missing in package.xml, since labkit does not know their
            packages.
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
    launch_files: Sequence[str | Path] = (),
    overwrite: bool = False,
) -> Exported:
    """Make a ROS 2 package from node classes of this notebook.

    Each class becomes a module with a `main()` and an entry in setup.py, and gets a test.
    Everything it uses from the notebook (imports, constants, functions, base classes) is included.
    The package needs neither labkit nor the notebook: `colcon build` builds it on any machine with
    ROS 2. Each module is first loaded in a Python of its own, where no node starts.

    Args:
        node_classes: One or more subclasses of `rclpy.node.Node` that need no arguments.
        package: Name of the package, in lower-case letters, digits and underscores.
        folder: Parent folder of the package, such as the `src` of a workspace.
        description: A sentence on its purpose; by default made from the names of the classes.
        license: An SPDX identifier, or any other text. Apache-2.0 adds a file LICENSE.
        maintainer_name: Its maintainer; by default the user of this computer.
        maintainer_email: Their address; by default git's, or a placeholder.
        launch_files: Launch files to put into its folder `launch`, and to install from there.
        overwrite: Whether to replace an existing package of that name.

    Returns:
        A summary of the package.

    Raises:
        LabError: A class uses something that can't be included, its module does not load in a
            Python without the notebook, or the folder exists, or one beside it has that package.
    """
    check_name(package)
    modules = _modules(node_classes)
    sources = {name: _source(cls, package, name) for name, cls in modules.items()}
    dependencies, unnamed = _dependencies(sources.values())
    maintainer = maintainer_name or own_name()
    names = ' and '.join(cls.__name__ for cls in node_classes)
    skeleton = Skeleton(
        name=package,
        maintainer=maintainer,
        email=maintainer_email or own_email(maintainer),
        description=description or f'The node{"s" * (len(modules) > 1)} {names}',
        license=license,
        dependencies=dependencies,
        test_dependencies=['python3-pytest'],
        scripts=[(name, f'{package}.{name}:main') for name in modules],
        launch_files=[Path(path).name for path in launch_files],
    )
    parts = [*_parts(skeleton, modules, sources), *_launch_parts(launch_files)]
    target = Path(folder) / package
    _make(parts, target, overwrite=overwrite)
    files = sorted(part.path for part in parts if part.text is not None)
    return Exported(package, target, files, list(modules), dependencies, unnamed)


def _parts(
    skeleton: Skeleton, modules: Mapping[str, type], sources: Mapping[str, str]
) -> list[Part]:
    """Return the parts of the package."""
    package = skeleton.name
    parts = [
        *skeleton.parts(),
        *(Part(f'{package}/{name}.py', text) for name, text in sources.items()),
        *(_test(name, cls, package) for name, cls in modules.items()),
    ]
    text = license_text(skeleton.license)
    return parts if text is None else [*parts, Part('LICENSE', text)]


def _launch_parts(paths: Sequence[str | Path]) -> list[Part]:
    """Return the folder `launch` with copies of launch files.

    Raises:
        LabError: One can't be read.
    """
    parts = [Part('launch')] if paths else []
    for path in paths:
        try:
            text = read_limited(path).decode()
        except (OSError, UnicodeDecodeError) as error:
            raise LabError(f'The launch file {path} can not be read: {error}.') from error
        parts.append(Part(f'launch/{Path(path).name}', text))
    return parts


def _modules(node_classes: Sequence[type]) -> dict[str, type]:
    """Return the classes by module name.

    Raises:
        LabError: One is not a node class, or needs arguments.
    """
    from rclpy.node import Node

    if not node_classes:
        raise LabError('Which class?', todo="lab.export(Talker, package='my_package')")
    found: dict[str, type] = {}
    for cls in node_classes:
        if isinstance(cls, Node):
            name = type(cls).__name__
            raise LabError(
                f'lab.export takes the class, and {name}() is one of its nodes.',
                todo=f'Write {name} without brackets, and without lab.spin.',
            )
        if not (inspect.isclass(cls) and issubclass(cls, Node)):
            raise LabError(
                f'lab.export takes classes of nodes, and this is {quoted(cls)}.',
                todo='Write a class that begins with: class Talker(Node):',
            )
        if cls.__module__.partition('.')[0] == 'labkit':
            raise LabError(
                f'{cls.__name__} belongs to labkit, the helper of this notebook.',
                todo='Export a class of your own, that uses rclpy alone.',
            )
        if '<locals>' in cls.__qualname__ or cls.__name__ != cls.__qualname__:
            raise LabError(
                f'{cls.__name__} is defined inside of {cls.__qualname__.split(".")[0]}.',
                todo='Write the class at the beginning of a line, in a cell.',
            )
        _refuse_arguments(cls)
        name = re.sub(r'(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])', '_', cls.__name__)
        name = name.lower()
        if name in found and found[name] is not cls:
            raise LabError(f'Two of the classes would both become {name}.py.')
        found[name] = cls
    return found


def _refuse_arguments(cls: type) -> None:
    """Raise a LabError if a class needs arguments, which `ros2 run` does not give."""
    needed = [
        one.name
        for one in inspect.signature(cls).parameters.values()
        if one.default is one.empty and one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
    ]
    if needed:
        raise LabError(
            f'{cls.__name__}() needs {first_few(needed)}, and `ros2 run` gives it nothing.',
            todo=f'Give each a value to begin with, as in __init__(self, {needed[0]}=...), or '
            'make it a parameter of the node.',
        )


def _source(cls: type, package: str, module: str) -> str:
    """Return the source of the module of a class, which loads in a fresh Python."""
    notebook = Notebook.of(cls)
    gathered = gather(cls, notebook)
    text = _module_text(cls, package, gathered)
    gathered.imports |= lacking_imports(f'{package}.{module}', text, gathered, notebook)
    return _module_text(cls, package, gathered)


def _module_text(cls: type, package: str, gathered: Gathered) -> str:
    summary = (inspect.cleandoc(cls.__doc__ or '').partition('\n')[0]) or (
        f'The node {cls.__name__} of the package {package}.'
    )
    if cls.__doc__ == getattr(cls.__base__, '__doc__', None):
        summary = f'The node {cls.__name__} of the package {package}.'
    needed = {'import rclpy', 'from rclpy.executors import ExternalShutdownException'}
    groups = _groups(gathered)
    short = _is_short(gathered.definitions[0])
    return _MODULE.format(
        summary=summary.replace('\\', '\\\\').replace('"', "'"),
        imports=_import_lines(gathered.imports | needed, annotations=gathered.annotations),
        definitions='\n' * (1 if short else 2) + '\n\n\n'.join(groups),
        name=cls.__name__,
    )


def _groups(gathered: Gathered) -> list[str]:
    """Return the statements, with consecutive constants in one group."""
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
        top = statement.split()[1].partition('.')[0]
        groups[top not in sys.stdlib_module_names].append(statement)

    def key(statement: str) -> tuple[str, str]:
        return statement.split()[1], statement

    blocks = ['from __future__ import annotations'] if annotations else []
    blocks += ['\n'.join(_joined(sorted(group, key=key))) for group in groups if group]
    return '\n\n'.join(blocks)


def _joined(statements: Sequence[str]) -> list[str]:
    """Combine imports from one module into one statement."""
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


def _dependencies(sources: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return the dependencies for package.xml, and modules of unknown packages."""
    from labkit.rosgraph.interfaces import buildable
    from labkit.rosgraph.packages import package_names

    modules: set[str] = set()
    for source in sources:
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Import):
                modules |= {alias.name.partition('.')[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                modules.add(node.module.partition('.')[0])
    others = sorted(modules - set(sys.stdlib_module_names))
    known = {*package_names(), *(name.partition('/')[0] for name in buildable())}
    named = [_ROSDEP.get(name, name) for name in others if name in known or name in _ROSDEP]
    return named, [name for name in others if name not in known and name not in _ROSDEP]


def _test(module: str, cls: type, package: str) -> Part:
    node_name = _literal_name(cls)
    claim = f'node.get_name() == {node_name!r}' if node_name else 'node.get_name()'
    text = _TEST.format(name=cls.__name__, package=package, module=module, claim=claim)
    return Part(f'test/test_{module}.py', text)


def _literal_name(cls: type) -> str:
    """Return the name that a class gives its nodes, `''` if it is not a literal."""
    definition = Notebook.of(cls).find(cls.__name__)
    for node in ast.walk(definition.node) if definition is not None else ():
        if isinstance(node, ast.Call) and ast.unparse(node.func) == 'super().__init__':
            first = node.args[0] if node.args else None
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                return first.value
    return ''


def _make(parts: Sequence[Part], target: Path, *, overwrite: bool) -> None:
    """Write the files of a package, replacing an existing one if allowed.

    Raises:
        LabError: The folder exists, or can't be written; or one beside it has the package.
    """
    for other in sorted(target.parent.glob('*/')):
        if other.name != target.name and _has_package(other, target.name):
            raise LabError(
                f'{other} is a package with the name {target.name}, too, and colcon builds each '
                'name once.',
                todo='Take another name, or move that folder away.',
            )
    if target.exists() or target.is_symlink():
        if not overwrite:
            raise LabError(
                f'{target} is there already.',
                todo='overwrite=True replaces it, with all that you have changed in it.',
            )
        if target.is_symlink() or not _has_package(target, target.name):
            raise LabError(
                f'{target} is there, and is no package of that name: it is not overwritten.',
                todo='Take another name, or another folder.',
            )
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with replaced(target):
            for part in parts:
                part.write(target)
    except OSError as error:
        raise LabError(f'{error.filename} can not be made: {error.strerror}.') from error


def _has_package(folder: Path, name: str) -> bool:
    """Return whether a folder is the package of a name."""
    try:
        text = read_limited(folder / 'package.xml').decode()
        return f'<name>{name}</name>' in text
    except (OSError, UnicodeDecodeError):
        return False
