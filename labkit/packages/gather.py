"""Collecting everything that a node class of a notebook needs, for a module.

Names used by the class are followed to the cells that define them: imports, constants, functions
and base classes are included. What can't be included is named, with its line.
"""

from __future__ import annotations

import ast
import builtins
import inspect
import symtable
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NoReturn

from labkit.errors import LabError, did_you_mean, quoted
from labkit.packages.cells import Definition, Notebook, Position, place

__all__ = ['Gathered', 'gather']

# Names that IPython adds to Python's, and that a program does not have.
_IPYTHON_NAMES = {'display', 'get_ipython', '__IPYTHON__'}
_PYTHON_NAMES = set(dir(builtins)) - _IPYTHON_NAMES
# Names that every module has.
_MODULE_NAMES = {'__name__', '__file__', '__doc__', '__package__', '__spec__'}
_LABKIT = 'It belongs to labkit, the helper of this notebook: on a robot it is not there.'
# Names used by the module's `main()`.
RESERVED = {'main', 'rclpy', 'ExternalShutdownException'}


@dataclass
class Gathered:
    """The content of a module.

    Attributes:
        name: Name of the class.
        imports: Statements such as `'import math'`.
        submodules: Modules that are reached as attributes of their packages.
        definitions: The other statements, in executable order.
        annotations: Whether annotations are not evaluated, see `from __future__`.
    """

    name: str
    imports: set[str] = field(default_factory=set)
    submodules: set[str] = field(default_factory=set)
    definitions: list[Definition] = field(default_factory=list)
    annotations: bool = False


def gather(node_class: type, notebook: Notebook) -> Gathered:
    """Return the content of a module with this class.

    Args:
        node_class: The class.
        notebook: The notebook that defines it.

    Raises:
        LabError: It uses something that can't be included. The message names it, and its line.
    """
    collector = _Collector(node_class.__name__, notebook)
    name = node_class.__name__
    definition = notebook.find(name)
    if definition is None or not isinstance(definition.node, ast.ClassDef):
        raise LabError(
            f'The source of {name} is not in a cell of this notebook.',
            todo='Write the class at the beginning of a line, in a cell without %% at its top, '
            'and run that cell.',
        )
    collector.take(definition)
    return Gathered(
        name,
        collector.imports,
        collector.submodules,
        _in_order(collector),
        notebook.has_annotations_as_text,
    )


class _Collector:
    """Follows names to their statements.

    Args:
        name: Name of the exported class.
        notebook: The notebook that defines the names.

    Attributes:
        imports: The required import statements.
        submodules: Modules that the statements reach as attributes of their packages.
        taken: The included statements, by position, each with the names it uses: all, and those it
            needs when it is executed.
    """

    def __init__(self, name: str, notebook: Notebook) -> None:
        self.name = name
        self.notebook = notebook
        self.imports: set[str] = set()
        self.submodules: set[str] = set()
        self.taken: dict[Position, tuple[Definition, set[str], set[str]]] = {}
        self._known: set[str] = set()

    def take(self, definition: Definition) -> None:
        """Include a statement, and everything it needs."""
        if definition.position in self.taken:
            return
        source = ast.unparse(definition.node)
        used = _free_names(source)
        self.taken[definition.position] = (
            definition,
            used,
            used & _eager_names(definition.node),
        )
        for node in ast.walk(definition.node):
            if isinstance(node, (ast.Import, ast.ImportFrom)) and 'labkit' in _modules_of(node):
                self._refuse('labkit', definition, _LABKIT, f'Write {self.name} without it.')
        for name in sorted(used - _MODULE_NAMES):
            self._follow(name, definition)
        modules = {name: self.notebook.namespace.get(name) for name in used}
        self.submodules |= set(_submodules(definition.node, modules))

    def _follow(self, name: str, user: Definition) -> None:
        if name in self._known:
            return
        self._known.add(name)
        value = self.notebook.namespace.get(name)
        self._refuse_labkit(name, value, user)
        found = self.notebook.find(name)
        if found is not None and isinstance(found.node, (ast.Import, ast.ImportFrom)):
            self.imports.add(_import_of(found.node, name))
        elif found is not None and found.plain:
            self._refuse_live(name, value, user, found)
            if name in RESERVED:
                self._refuse(
                    name, user, f'The program that is made has its own {name}.', 'Rename yours.'
                )
            self.take(found)
        elif name in self.notebook.namespace and (statement := _import_for(name, value)):
            self.imports.add(statement)
        elif found is not None:
            self._refuse(
                name,
                user,
                f'{place(found.cell, found.node.lineno)} gives it its value inside of another '
                'statement.',
                'Write it at the beginning of a line, in a statement of its own.',
            )
        elif name not in _PYTHON_NAMES:
            self._refuse_unknown(name, user)

    def _refuse_labkit(self, name: str, value: Any, user: Definition) -> None:
        module = value.__name__ if inspect.ismodule(value) else getattr(value, '__module__', '')
        if str(module).partition('.')[0] == 'labkit':
            self._refuse(
                name,
                user,
                _LABKIT,
                f'Write {self.name} without it.',
            )

    def _refuse_live(self, name: str, value: Any, user: Definition, found: Definition) -> None:
        """Refuse what exists only in a running program: a node, or a part of one."""
        if isinstance(found.node, (ast.Assign, ast.AnnAssign)) and not inspect.isclass(value):
            module = type(value).__module__
            own = isinstance(value, _node_class()) or (
                module.startswith('rclpy.') and hasattr(value, 'handle')
            )
            if own or module.partition('.')[0] == 'labkit':
                self._refuse(
                    name,
                    user,
                    f'It is a {type(value).__name__} that runs in this notebook: '
                    f'{place(found.cell, found.node.lineno)}',
                    f'Let {self.name} make what it needs in its __init__, as self.{name}.',
                )

    def _refuse_unknown(self, name: str, user: Definition) -> NoReturn:
        if name in _IPYTHON_NAMES:
            self._refuse(
                name,
                user,
                'It belongs to notebooks (a line with % or ! uses it): a program does not have '
                'it.',
                'Leave that line out; print() and get_logger() work everywhere.',
            )
        if name in sys.stdlib_module_names:
            todo = f'Run a cell with: import {name}'
        else:
            todo = did_you_mean(
                name,
                [*self.notebook.namespace, *_PYTHON_NAMES],
                'Import it, or define it, in a cell.',
            )
        self._refuse(name, user, 'No cell of this notebook has made it.', todo)

    def _refuse(self, name: str, user: Definition, why: str, todo: str) -> NoReturn:
        raise LabError(
            f'{self.name} can not become a package: it uses {quoted(name)}.\n'
            f'{place(user.cell, _line_of(name, user))}\n{why}',
            todo=todo,
        )


def _node_class() -> type:
    from rclpy.node import Node

    return Node


def _in_order(collector: _Collector) -> list[Definition]:
    """Return the statements in their original order, but each after what it needs at once."""
    taken = collector.taken
    makes: dict[str, set[Position]] = {}
    for position, (definition, _, _) in taken.items():
        makes.setdefault(definition.name, set()).add(position)
        for name in _names_made(definition.node):
            makes.setdefault(name, set()).add(position)

    def needs(position: Position, seen: set[Position]) -> set[Position]:
        """Return what has to precede a statement."""
        definition, used, eager = taken[position]
        # A value may come from a call: then everything that the function uses is needed, too.
        names = used if isinstance(definition.node, (ast.Assign, ast.AnnAssign)) else eager
        found: set[Position] = set()
        for name in names:
            for other in makes.get(name, ()):
                if other != position and other not in seen:
                    found |= {other} | needs(other, {*seen, position, other})
        return found

    left, result, done = sorted(taken), [], set[Position]()
    before = {position: needs(position, {position}) for position in left}
    while left:
        ready = next((each for each in left if before[each] <= done), left[0])
        left.remove(ready)
        done.add(ready)
        result.append(taken[ready][0])
    return result


def _names_made(node: ast.stmt) -> Iterator[str]:
    for inner in ast.walk(node) if isinstance(node, (ast.Assign, ast.AnnAssign)) else ():
        if isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store):
            yield inner.id


def _free_names(source: str) -> set[str]:
    """Return the names that a statement uses but does not define."""
    top = symtable.symtable(source, 'cell', 'exec')
    made = {symbol.get_name() for symbol in top.get_symbols() if symbol.is_assigned()}
    used: set[str] = set()
    tables = [top]
    while tables:
        table = tables.pop()
        tables += table.get_children()
        used |= {
            symbol.get_name()
            for symbol in table.get_symbols()
            if symbol.is_referenced() and (table is top or symbol.is_global())
        }
        # `global count` binds a name of the module, which need not be read.
        used |= {each.get_name() for each in table.get_symbols() if each.is_declared_global()}
    return used - made


def _submodules(node: ast.stmt, values: Mapping[str, Any]) -> Iterator[str]:
    """Yield the modules that a statement reaches as attributes, as `rclpy.node.Node` does."""

    def value(expression: ast.AST) -> Any:
        if isinstance(expression, ast.Name):
            return values.get(expression.id)
        if isinstance(expression, ast.Attribute) and inspect.ismodule(
            outer := value(expression.value)
        ):
            return vars(outer).get(expression.attr)
        return None

    for each in ast.walk(node):
        inner = value(each)
        if isinstance(each, ast.Attribute) and inspect.ismodule(inner):
            package = value(each.value)
            if inner.__name__ == f'{package.__name__}.{each.attr}':
                yield inner.__name__


def _eager_names(node: ast.stmt) -> set[str]:
    """Return the names that a statement reads when executed, not later in a function."""
    names: set[str] = set()
    waiting: list[ast.AST] = [node]
    while waiting:
        each = waiting.pop()
        if isinstance(each, ast.Name):
            names.add(each.id)
        if isinstance(each, (ast.FunctionDef, ast.AsyncFunctionDef)):
            waiting += [*each.decorator_list, each.args]
            waiting += [each.returns] if each.returns else []
        elif isinstance(each, ast.Lambda):
            waiting.append(each.args)
        else:
            waiting += list(ast.iter_child_nodes(each))
    return names


def _line_of(name: str, user: Definition) -> int:
    """Return the first line of a statement that uses a name."""
    lines = [
        node.lineno
        for node in ast.walk(user.node)
        if (isinstance(node, ast.Name) and node.id == name)
        or (isinstance(node, (ast.Import, ast.ImportFrom)) and name in _modules_of(node))
    ]
    return min(lines, default=user.node.lineno)


def _modules_of(node: ast.Import | ast.ImportFrom) -> set[str]:
    """Return the packages that a statement imports from."""
    names = [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        names = [node.module or '']
    return {name.partition('.')[0] for name in names}


def _import_of(node: ast.Import | ast.ImportFrom, name: str) -> str:
    """Return the import of one name from a statement that may import several."""
    for alias in node.names:
        if (alias.asname or alias.name.partition('.')[0]) == name:
            what = f'{alias.name} as {alias.asname}' if alias.asname else alias.name
            if isinstance(node, ast.Import):
                return f'import {what}'
            return f'from {"." * node.level}{node.module or ""} import {what}'
    raise AssertionError(name)


def _import_for(name: str, value: Any) -> str:
    """Return an import that gives a name this value, `''` if there is none."""
    if inspect.ismodule(value):
        return f'import {value.__name__}' + (f' as {name}' if value.__name__ != name else '')
    module = getattr(value, '__module__', '') or ''
    real = getattr(value, '__name__', '')
    if module in ('', '__main__') or getattr(sys.modules.get(module), real, None) is not value:
        return ''
    return f'from {module} import {real}' + (f' as {name}' if real != name else '')
