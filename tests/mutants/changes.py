"""Small changes to any Python program: constants, operators, names, statements."""

from __future__ import annotations

import ast
import builtins
import copy
from collections.abc import Container, Iterator
from typing import Any

__all__ = ['SIBLINGS', 'Change', 'bodies', 'misspelt', 'other_values', 'plain_changes']

# What kind of change it is, and the changed program.
Change = tuple[str, str]
_COMPARISONS = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
}
_OPERATORS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
# What people write in place of a name.
SIBLINGS = {
    'x': 'y',
    'y': 'x',
    'z': 'x',
    'w': 'z',
    'linear': 'angular',
    'angular': 'linear',
    'position': 'orientation',
    'upper': 'title',
    'sin': 'cos',
    'cos': 'sin',
    'min': 'max',
    'inf': 'pi',
    'node_name': 'node_namespace',
}
# Misspelt, these give a NameError in the cell and teach nothing about a check.
_NO_NAMES = {*dir(builtins), 'self', 'lab'}


def _exchanged(tree: ast.Module, old: object, new: object) -> str:
    """Return the text of a tree with a part of it (a node, a list) exchanged for another one."""
    for holder, key in _places(tree):
        if holder[key] is old:
            holder[key] = new
            text = ast.unparse(tree)
            holder[key] = old
            return text
    raise ValueError(f'{old} is not in the tree')


def _places(tree: ast.Module) -> Iterator[tuple[Any, Any]]:
    """Give where parts of a tree are kept: a dictionary or a list, and the key in it."""
    for node in ast.walk(tree):
        for field, value in ast.iter_fields(node):
            yield vars(node), field
            if isinstance(value, list):
                yield from ((value, i) for i in range(len(value)))


def plain_changes(tree: ast.Module, free: Container[int] = ()) -> Iterator[Change]:
    """Give changes that need no knowledge of ROS.

    Args:
        tree: A program.
        free: The `id` of each constant that may be anything.
    """
    for node in ast.walk(tree):
        if id(node) in free:
            continue
        for kind, new in _in_place(node):
            yield kind, _exchanged(tree, node, new)
    for kind, node, new in _names(tree):
        yield kind, _exchanged(tree, node, new)
    yield from statement_changes(tree)


def _in_place(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    if isinstance(node, ast.Constant):
        for value in other_values(node.value):
            yield 'constant', ast.parse(repr(value), mode='eval').body
    elif isinstance(node, (ast.BinOp, ast.AugAssign)) and type(node.op) in _OPERATORS:
        yield 'operator', _copy(node, op=_OPERATORS[type(node.op)]())
    elif isinstance(node, ast.Compare):
        for other in _COMPARISONS.get(type(node.ops[0]), ()):
            yield 'operator', _copy(node, ops=[other()])
    elif isinstance(node, ast.BoolOp):
        yield 'operator', _copy(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
    elif isinstance(node, ast.UnaryOp):
        yield 'operator', node.operand
    elif isinstance(node, ast.If):
        for value in (True, False):
            yield 'condition', _copy(node, test=ast.Constant(value))
    elif isinstance(node, ast.Call) and len(node.args) > 1:
        yield 'arguments', _copy(node, args=[node.args[1], node.args[0], *node.args[2:]])


def _copy(node: ast.AST, **fields: object) -> ast.AST:
    new = copy.copy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return new


def other_values(value: object) -> list[object]:
    """Return other values of the same type; none for a type that has no neighbours."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, value - 1, 2 * value, 0, -value]
    if isinstance(value, float):
        return [round(value * 1.1, 6), value * 0.5, value * 2, -value] if value else [1.0, -1.0]
    if isinstance(value, str) and value:
        middle = len(value) // 2
        other = 'o' if value[middle] == 'a' else 'a'
        spaced = value[:-1] if value.endswith(' ') else f'{value} '
        letter = next((i for i, c in enumerate(value) if c.isalpha()), 0)
        capital = value[:letter] + value[letter].swapcase() + value[letter + 1 :]
        return [value[:middle] + other + value[middle + 1 :], capital, spaced, '']
    return []


def _names(tree: ast.Module) -> Iterator[tuple[str, ast.AST, ast.AST]]:
    """Give kind, node and what stands there instead: each name misspelt once, or mistaken."""
    for node in _last_uses(tree):
        if isinstance(node, (ast.Name, ast.Attribute)):
            field = 'id' if isinstance(node, ast.Name) else 'attr'
            yield 'name', node, _copy(node, **{field: misspelt(getattr(node, field))})
        elif isinstance(node, ast.keyword):
            yield 'name', node, _copy(node, arg=misspelt(str(node.arg)))
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.alias)):
            yield 'name', node, _copy(node, name=misspelt(node.name))
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == 'self':
            others = [name for name in _attributes_of_self(tree) if name != node.attr]
            if others and len(others) < len(_attributes_of_self(tree)):
                after = next((name for name in others if name > node.attr), others[0])
                yield 'other-name', node, _copy(node, attr=after)
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and node.attr in SIBLINGS:
            yield 'other-name', node, _copy(node, attr=SIBLINGS[node.attr])


def _last_uses(tree: ast.Module) -> list[ast.AST]:
    """Return where each name is used last, and where each method is defined."""
    last: dict[tuple[bool, str], ast.AST] = {}
    nodes = [node for node in ast.walk(tree) if hasattr(node, 'lineno')]
    for node in sorted(nodes, key=lambda node: (node.lineno, getattr(node, 'col_offset', 0))):
        for field in ('id', 'attr', 'name', 'arg'):
            name = getattr(node, field, None)
            if isinstance(name, str) and name not in _NO_NAMES:
                if isinstance(getattr(node, 'ctx', None), ast.Store) and _is_never_read(
                    name, tree
                ):
                    continue
                last[isinstance(node, ast.FunctionDef), name] = node
    return list(last.values())


def misspelt(name: str) -> str:
    """Return a name without a letter in the middle."""
    middle = len(name) // 2
    return name[:middle] + name[middle + 1 :] if len(name) > 2 else f'{name}_'


def _is_never_read(name: str, tree: ast.Module) -> bool:
    """Tell whether a name or an attribute is only kept; how it is called is then all the same."""
    for node in ast.walk(tree):
        found = node.id if isinstance(node, ast.Name) else getattr(node, 'attr', None)
        if found == name and isinstance(getattr(node, 'ctx', None), ast.Load):
            return False
    return True


def _attributes_of_self(tree: ast.Module) -> list[str]:
    return sorted(
        {
            node.attr
            for node in ast.walk(tree)
            if isinstance(node, ast.Attribute)
            and isinstance(node.ctx, ast.Store)
            and isinstance(node.value, ast.Name)
            and node.value.id == 'self'
        }
    )


def statement_changes(tree: ast.Module) -> Iterator[Change]:
    """Give the program without each of its statements, in another order, with one twice."""
    for body in bodies(tree):
        for i, statement in enumerate(body):
            # A lesson has most names already, so nobody misses an import; a class everybody does.
            if not isinstance(statement, (ast.Import, ast.ImportFrom, ast.ClassDef)):
                rest = body[:i] + body[i + 1 :] or [ast.Pass()]
                yield 'removed', _exchanged(tree, body, rest)
            if i + 1 < len(body) and _order_counts(statement, body[i + 1]):
                order = [*body[:i], body[i + 1], statement, *body[i + 2 :]]
                yield 'order', _exchanged(tree, body, order)
            if _counts_twice(statement):
                yield 'twice', _exchanged(tree, body, [*body[: i + 1], *body[i:]])


def bodies(tree: ast.AST) -> list[list[ast.stmt]]:
    """Return all lists of statements in a tree."""
    lists = (getattr(n, name, []) for n in ast.walk(tree) for name in ('body', 'orelse'))
    return [body for body in lists if isinstance(body, list) and body]


def _order_counts(first: ast.stmt, second: ast.stmt) -> bool:
    """Tell whether one of two statements may see what the other one does."""
    definitions = (ast.Import, ast.ImportFrom, ast.ClassDef, ast.FunctionDef)
    if isinstance(first, definitions) or isinstance(second, definitions):
        return isinstance(first, ast.ClassDef) and not isinstance(second, definitions)
    if all(isinstance(s, ast.Expr) for s in (first, second)):
        return not all('create_' in ast.unparse(s) for s in (first, second))
    if any('super()' in ast.unparse(s) for s in (first, second)):
        return True
    if any(isinstance(node, ast.Return) for s in (first, second) for node in ast.walk(s)):
        return True
    return _touches(first, second) or _touches(second, first)


def _touches(writer: ast.stmt, reader: ast.stmt) -> bool:
    """Tell whether one statement sets what the other one names, or a part of it."""
    set_, named = _paths(writer, ast.Store), _paths(reader, (ast.Store, ast.Load))
    return any(
        f'{a}.'.startswith(f'{b}.') or f'{b}.'.startswith(f'{a}.') for a in set_ for b in named
    )


def _paths(statement: ast.stmt, context: type | tuple[type, ...]) -> set[str]:
    found = set()
    for node in ast.walk(statement):
        if isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, context):
            path = ast.unparse(node)
            if path not in ('self', 'lab'):
                found.add(path)
    return found


def _counts_twice(statement: ast.stmt) -> bool:
    text = ast.unparse(statement)
    if isinstance(statement, ast.Expr):
        return 'super()' not in text and 'lab.spin' not in text
    makes = 'create_timer(' in text or 'create_subscription(' in text
    return isinstance(statement, ast.AugAssign) or (isinstance(statement, ast.Assign) and makes)
