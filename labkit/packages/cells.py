"""The origin of a name in the notebook: the statement that defines it, with its cell."""

from __future__ import annotations

import ast
import inspect
import linecache
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import CodeType
from typing import Any

from labkit import settings
from labkit.errors import cell_name

__all__ = ['Cell', 'Definition', 'Notebook', 'Position', 'place']


Position = tuple[int, str, int]


@dataclass(frozen=True)
class Cell:
    """An executed cell, or the file of a module.

    Attributes:
        label: Its name, such as `'Cell In[3]'`.
        number: Its execution count.
        source: Its text.
    """

    label: str
    number: int
    source: str

    @cached_property
    def body(self) -> list[ast.stmt]:
        """Its statements; none if it is not Python."""
        try:
            return ast.parse(self.source).body
        except (SyntaxError, ValueError):
            return []


@dataclass(frozen=True)
class Definition:
    """A statement that binds a name.

    Attributes:
        cell: The cell of the statement.
        node: The statement.
        plain: Whether it is at top level, not in a loop, a condition or a `with` block.
    """

    name: str
    cell: Cell
    node: ast.stmt
    plain: bool = True

    @property
    def position(self) -> Position:
        """Its place in the order of execution; code run by a magic repeats the cell's number."""
        return self.cell.number, self.cell.source, self.node.lineno

    @property
    def text(self) -> str:
        """Its source, with decorators and the comment above it."""
        lines = self.cell.source.splitlines()
        first = min(_first_lines(self.node))
        whole = ast.get_source_segment(self.cell.source, self.node) or ''
        above = first - 1
        while above > 0 and lines[above - 1].startswith('#'):
            above -= 1
        before = lines[above : self.node.lineno - 1]
        return '\n'.join([*before, whole])


class Notebook:
    """The definitions in executed cells.

    Args:
        namespace: The names defined by cells, with their values.
        cells: The cells, in order of execution.
    """

    def __init__(self, namespace: dict[str, Any], cells: Sequence[Cell]) -> None:
        self.namespace = namespace
        self.cells = cells

    @classmethod
    def of(cls, thing: Any) -> Notebook:
        """Return the running notebook, or the module in which a class or function was defined."""
        module = sys.modules.get(thing.__module__)
        shell = settings.shell()
        if shell is not None and thing.__module__ == '__main__':
            history = shell.history_manager.input_hist_parsed
            cells = [Cell(f'Cell In[{n}]', n, text) for n, text in enumerate(history)]
            return cls(shell.user_ns, cells)
        path = getattr(module, '__file__', None) or ''
        source = ''.join(linecache.getlines(path))
        return cls(vars(module) if module else {}, [Cell(path.rpartition('/')[2], 0, source)])

    @property
    def has_annotations_as_text(self) -> bool:
        """Whether a cell has imported `annotations` from `__future__`."""
        return any(
            isinstance(node, ast.ImportFrom)
            and node.module == '__future__'
            and any(alias.name == 'annotations' for alias in node.names)
            for cell in self.cells
            for node in cell.body
        )

    def find(self, name: str) -> Definition | None:
        """Return the statement that defines a name, None if no cell does.

        For a class or a function, it is the statement that made the current value.
        """
        own = self._cell_of(self.namespace.get(name))
        for cell in [*([own] if own else []), *reversed(self.cells)]:
            found = [each for each in definitions(cell) if each.name == name]
            if found:
                return found[-1]
        return None

    def _cell_of(self, value: Any) -> Cell | None:
        """Return the cell in which a class or function was defined, if its code tells."""
        for code in _codes(value):
            label = cell_name(code.co_filename)
            if label:
                number = re.search(r'\d+', label)
                source = ''.join(linecache.getlines(code.co_filename))
                if number:
                    return Cell(label, int(number[0]), source)
                # Without numbers, as in an old IPython: take the last cell with that text.
                text = source.rstrip()
                same = (cell for cell in reversed(self.cells) if cell.source.rstrip() == text)
                return next(same, Cell(label, 0, source))
        return None


def definitions(cell: Cell) -> Iterator[Definition]:
    """Yield the names bound by a cell's statements."""
    for node in cell.body:
        for name in _bound(node):
            yield Definition(name, cell, node)
        if isinstance(node, (ast.If, ast.Try, ast.With, ast.For, ast.While)):
            for inner in ast.walk(node):
                if inner is not node and isinstance(inner, ast.stmt):
                    for name in _bound(inner):
                        yield Definition(name, cell, inner, plain=False)
            if isinstance(node, ast.For):
                for name in _targets([node.target]):
                    yield Definition(name, cell, node, plain=False)
            if isinstance(node, ast.With):
                targets = [item.optional_vars for item in node.items if item.optional_vars]
                for name in _targets(targets):
                    yield Definition(name, cell, node, plain=False)


def place(cell: Cell, line: int) -> str:
    """Return a line of a cell for an error message."""
    text = cell.source.splitlines()[line - 1].strip() if cell.source else ''
    return f'{cell.label}, line {line}: {text}'


def _bound(node: ast.stmt) -> Iterator[str]:
    """Yield the names bound by one statement."""
    if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
        yield node.name
    elif isinstance(node, ast.Assign):
        yield from _targets(node.targets)
    elif isinstance(node, ast.AnnAssign) and node.value is not None:
        yield from _targets([node.target])
    elif isinstance(node, (ast.Import, ast.ImportFrom)):
        for alias in node.names:
            yield alias.asname or alias.name.partition('.')[0]


def _targets(targets: Sequence[ast.expr]) -> Iterator[str]:
    for target in targets:
        for node in ast.walk(target):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                yield node.id


def _first_lines(node: ast.stmt) -> list[int]:
    decorators = getattr(node, 'decorator_list', [])
    return [node.lineno, *(each.lineno for each in decorators)]


def _codes(value: Any) -> Iterator[CodeType]:
    """Yield the code of a function, or of the methods of a class."""
    values = vars(value).values() if inspect.isclass(value) else [value]
    for each in values:
        each = getattr(each, 'fget', None) or getattr(each, '__func__', each)
        code = getattr(inspect.unwrap(each) if callable(each) else each, '__code__', None)
        if isinstance(code, CodeType):
            yield code
