"""The safe evaluator of `$(eval ...)` and `PythonExpression`, and of `ros2 topic echo --filter`.

The real ones call Python's `eval`. Here an expression is arithmetic, comparisons, `and`, `or`,
`not`, `if` and texts, and it can not grow without bounds. That of a launch file can not call
anything. A filter knows the message `m` and its fields, and calls a few functions that are listed
here.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from labkit.errors import LabError, did_you_mean, quoted
from labkit.launching.model import LaunchError

__all__ = ['evaluate', 'message_filter']

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
# What makes no more out of what it gets: not round(), which can take hours.
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    each.__name__: each for each in (abs, all, any, bool, float, int, len, max, min, str, sum)
}
_OF_TEXTS = (
    *('endswith', 'lower', 'partition', 'rpartition', 'rstrip', 'split', 'startswith', 'strip'),
    'upper',
)
_FAULTS = (ArithmeticError, LookupError, TypeError, ValueError, RecursionError, MemoryError)


@dataclass(frozen=True)
class _Scope:
    """What an expression can name.

    Attributes:
        names: The names with their values.
        takes: What it is made of, for messages.
        of_message: Whether it has fields, indices and functions.
    """

    names: Mapping[str, Any]
    takes: str = 'numbers, texts, + - * / // % **, comparisons, in, and, or, not, if'
    of_message: bool = False


_OF_LAUNCH = _Scope(_NAMES)


def message_filter(expression: str, sample: Any) -> Callable[[Any], bool]:
    """Return a function that tells whether an expression over `m` is true for a message.

    It raises a LabError if the expression has no value for that message, as the first item of an
    empty list has none.

    Args:
        expression: Such as `m.data > 5`, or `int(m.data.rpartition(':')[-1]) % 2 == 0`.
        sample: A message of the type, whatever it holds.

    Raises:
        LabError: It is no expression, or names what such a message does not have.
    """
    if len(expression) > LONGEST:
        raise LabError(f'The expression has more than {LONGEST} characters.')
    try:
        body = ast.parse(expression.strip(), mode='eval').body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        why = error.msg if isinstance(error, SyntaxError) else str(error)
        raise LabError(
            f'{quoted(expression)} is no expression: {why}.',
            todo='Such as "m.data > 5": m is the message.',
        ) from error
    calls = ', '.join(f'{name}()' for name in _FUNCTIONS)
    takes = f'm (the message) and its fields, {_OF_LAUNCH.takes}, {calls}'

    def value_for(message: Any) -> bool:
        try:
            return bool(_value(body, _Scope({'m': message}, takes, of_message=True)))
        except LaunchError as error:
            raise LabError(f'{expression}: {error.plain}', todo=error.todo) from error

    def passes(message: Any) -> bool:
        try:
            return value_for(message)
        except _FAULTS as error:
            raise LabError(f'{expression}: {error}.') from error

    with suppress(*_FAULTS):  # of the values that the sample has
        value_for(sample)
    return passes


def evaluate(expression: str) -> str:
    """Return the value of an expression as a text, as `str()` writes it.

    Raises:
        LaunchError: It is no expression, or more than is allowed.
    """
    if len(expression) > LONGEST:
        raise LaunchError(f'The expression has more than {LONGEST} characters.')
    try:
        return str(_value(ast.parse(expression.strip(), mode='eval').body, _OF_LAUNCH))
    except LaunchError as error:
        raise LaunchError(f'$(eval {expression}): {error.plain}', todo=error.todo) from error
    except SyntaxError as error:
        raise LaunchError(
            f'$(eval {expression}) is no expression: {error.msg}.',
            todo="A text in it needs quotation marks of its own: $(eval \"'$(var x)' == 'a'\")",
        ) from error
    except _FAULTS as error:
        raise LaunchError(f'$(eval {expression}): {error}.') from error


def _value(node: ast.expr, scope: _Scope) -> Any:
    if isinstance(node, ast.Constant) and isinstance(node.value, (bool, int, float, str)):
        return node.value
    if isinstance(node, (ast.List, ast.Tuple)):
        items = [_value(item, scope) for item in node.elts]
        return items if isinstance(node, ast.List) else tuple(items)
    if isinstance(node, ast.Name):
        if node.id in scope.names:
            return scope.names[node.id]
        meant = {'true': 'True', 'false': 'False'}.get(node.id, f"'{node.id}'")
        raise LaunchError(
            f'{node.id} is no name in it.',
            todo=f'Python writes {meant}.'
            if meant in ('True', 'False')
            else f'A text needs quotation marks: {meant}',
        )
    if isinstance(node, ast.UnaryOp) and type(node.op) in _UNARY:
        return _UNARY[type(node.op)](_value(node.operand, scope))
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        return _joined(node.op, _value(node.left, scope), _value(node.right, scope))
    if isinstance(node, ast.BoolOp):
        return _any_or_all(node, scope)
    if isinstance(node, ast.IfExp):
        return _value(node.body if _value(node.test, scope) else node.orelse, scope)
    if isinstance(node, ast.Compare) and all(type(op) in _BINARY for op in node.ops):
        left = _value(node.left, scope)
        for op, comparator in zip(node.ops, node.comparators, strict=True):
            right = _value(comparator, scope)
            if not _BINARY[type(op)](left, right):
                return False
            left = right
        return True
    if scope.of_message and isinstance(node, ast.Attribute):
        return _plain(_field(_value(node.value, scope), node.attr))
    if scope.of_message and isinstance(node, ast.Subscript):
        return _plain(_value(node.value, scope)[_index(node.slice, scope)])
    if scope.of_message and isinstance(node, ast.Call) and not node.keywords:
        function = _function(node.func, scope)
        if function is not None:
            return function(*(_value(each, scope) for each in node.args))
    raise LaunchError(
        f'{ast.unparse(node)} is not allowed in it.', todo=f'It takes {scope.takes}.'
    )


def _field(message: Any, name: str) -> Any:
    """Return a field of a message, and of nothing else."""
    fields: Mapping[str, str] = getattr(message, 'get_fields_and_field_types', dict)()
    if name not in fields:
        known = f'Its fields: {", ".join(fields)}.' if fields else ''
        raise LaunchError(
            f'{quoted(name)} is no field of a {type(message).__name__}.',
            todo=did_you_mean(name, fields, known),
        )
    return getattr(message, name)


def _plain(value: Any) -> Any:
    """Return a number of numpy as one of Python."""
    is_one = type(value).__module__ == 'numpy' and not getattr(value, 'shape', True)
    return value.item() if is_one else value


def _index(node: ast.expr, scope: _Scope) -> Any:
    if not isinstance(node, ast.Slice):
        return _value(node, scope)
    parts = (node.lower, node.upper, node.step)
    return slice(*(None if part is None else _value(part, scope) for part in parts))


def _function(node: ast.expr, scope: _Scope) -> Callable[..., Any] | None:
    """Return a function, or a method of a text, that may be called."""
    if isinstance(node, ast.Name):
        return _FUNCTIONS.get(node.id)
    if isinstance(node, ast.Attribute) and node.attr in _OF_TEXTS:
        text = _value(node.value, scope)
        if type(text) is str:
            method: Callable[..., Any] = getattr(text, node.attr)
            return method
    return None


def _any_or_all(node: ast.BoolOp, scope: _Scope) -> Any:
    ends_at = isinstance(node.op, ast.Or)
    value: Any = None
    for part in node.values:
        value = _value(part, scope)
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
