"""The safe evaluator of `$(eval ...)` and `PythonExpression`.

The real one calls Python's `eval`. Here an expression is arithmetic, comparisons, `and`, `or`,
`not`, `if` and texts, and it can neither call anything nor grow without bounds.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from typing import Any

from labkit.launching.model import LaunchError

__all__ = ['evaluate']

# The longest expression, text and list, and the most bits of a whole number.
LONGEST = 10_000
_NAMES = {'pi': math.pi, 'e': math.e, 'tau': math.tau, 'inf': math.inf, 'nan': math.nan}
_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda one, other: one in other,
    ast.NotIn: lambda one, other: one not in other,
}
_UNARY: dict[type, Callable[[Any], Any]] = {
    ast.Not: operator.not_,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}


def evaluate(expression: str) -> str:
    """Return the value of an expression as a text, as `str()` writes it.

    Raises:
        LaunchError: It is no expression, or more than is allowed.
    """
    if len(expression) > LONGEST:
        raise LaunchError(f'The expression has more than {LONGEST} characters.')
    try:
        return str(_value(ast.parse(expression.strip(), mode='eval').body))
    except LaunchError as error:
        raise LaunchError(f'$(eval {expression}): {error.plain}', todo=error.todo) from error
    except SyntaxError as error:
        raise LaunchError(
            f'$(eval {expression}) is no expression: {error.msg}.',
            todo="A text in it needs quotation marks of its own: $(eval \"'$(var x)' == 'a'\")",
        ) from error
    except (ArithmeticError, TypeError, ValueError, RecursionError, MemoryError) as error:
        raise LaunchError(f'$(eval {expression}): {error}.') from error


def _value(node: ast.expr) -> Any:
    if isinstance(node, ast.Constant) and isinstance(node.value, (bool, int, float, str)):
        return node.value
    if isinstance(node, (ast.List, ast.Tuple)):
        items = [_value(item) for item in node.elts]
        return items if isinstance(node, ast.List) else tuple(items)
    if isinstance(node, ast.Name):
        if node.id in _NAMES:
            return _NAMES[node.id]
        meant = {'true': 'True', 'false': 'False'}.get(node.id, f"'{node.id}'")
        raise LaunchError(
            f'{node.id} is no name in it.',
            todo=f'Python writes {meant}.'
            if meant in ('True', 'False')
            else f'A text needs quotation marks: {meant}',
        )
    if isinstance(node, ast.UnaryOp) and type(node.op) in _UNARY:
        return _UNARY[type(node.op)](_value(node.operand))
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        return _joined(node.op, _value(node.left), _value(node.right))
    if isinstance(node, ast.BoolOp):
        return _any_or_all(node)
    if isinstance(node, ast.IfExp):
        return _value(node.body if _value(node.test) else node.orelse)
    if isinstance(node, ast.Compare) and all(type(op) in _BINARY for op in node.ops):
        left = _value(node.left)
        for op, comparator in zip(node.ops, node.comparators, strict=True):
            right = _value(comparator)
            if not _BINARY[type(op)](left, right):
                return False
            left = right
        return True
    raise LaunchError(
        f'{ast.unparse(node)} is not allowed in it.',
        todo='It takes numbers, texts, + - * / // % **, comparisons, in, and, or, not, if.',
    )


def _any_or_all(node: ast.BoolOp) -> Any:
    ends_at = isinstance(node.op, ast.Or)
    value: Any = None
    for part in node.values:
        value = _value(part)
        if bool(value) == ends_at:
            break
    return value


def _joined(op: ast.operator, left: Any, right: Any) -> Any:
    """Return `left op right`, unless it would become too long."""
    numbers = isinstance(left, (int, float)) and isinstance(right, (int, float))
    if isinstance(op, ast.Mod) and not numbers:
        raise LaunchError('% takes numbers.')  # a format can ask for any width
    whole = isinstance(left, int) and isinstance(right, int)
    if isinstance(op, ast.Pow) and whole and left.bit_length() * abs(right) > LONGEST:
        raise LaunchError(f'{left} ** {right} is too large.')
    if isinstance(op, ast.Mult) and not numbers:
        length = [one for one in (left, right) if not isinstance(one, (int, float))]
        times = [one for one in (left, right) if isinstance(one, int)]
        if length and times and len(length[0]) * times[0] > LONGEST:
            raise LaunchError(f'It would have more than {LONGEST} characters.')
    value = _BINARY[type(op)](left, right)
    if isinstance(value, int) and value.bit_length() > LONGEST:
        raise LaunchError('The number is too large.')
    if isinstance(value, (str, list, tuple)) and len(value) > LONGEST:
        raise LaunchError(f'It would have more than {LONGEST} characters.')
    return value
