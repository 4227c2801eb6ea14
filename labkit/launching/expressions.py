"""The safe evaluator of `$(eval ...)` and `PythonExpression`, and of `ros2 topic echo --filter`.

The real ones call Python's `eval`. Here an expression is arithmetic, comparisons, `and`, `or`,
`not`, `if`, texts, lists and dictionaries, and it can not grow without bounds. It calls a few
functions and methods of texts, which are listed here. That of a launch file knows the names of the
module `math`, a filter the message `m` and its fields.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from labkit.errors import LabError, did_you_mean, quoted
from labkit.launching.model import LaunchError

__all__ = ['evaluate', 'message_filter']

# The longest expression, text and list, and the most bits of a whole number.
LONGEST = 10_000
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
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.BitOr: operator.or_,
    ast.BitAnd: operator.and_,
    ast.BitXor: operator.xor,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
}
_UNARY: dict[type, Callable[[Any], Any]] = {
    ast.Not: operator.not_,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Invert: operator.invert,
}


def _round(number: float, ndigits: int | None = None) -> float:
    """Round a number, to so few digits that it takes no time."""
    if ndigits is not None and abs(ndigits) > 300:
        raise LaunchError('round() takes up to 300 digits.')
    return round(number, ndigits)


# What makes little more out of what it gets.
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    'round': _round,
    **{
        each.__name__: each
        for each in (abs, all, any, bool, chr, float, int, len, max, min, ord, sorted, str, sum)
    },
}
_OF_TEXTS = (
    *('capitalize', 'count', 'endswith', 'find', 'isdigit', 'lower', 'lstrip', 'partition'),
    *('removeprefix', 'removesuffix', 'rpartition', 'rstrip', 'split', 'startswith', 'strip'),
    *('title', 'upper'),
)
# A conversion of %, with a width of up to three digits.
_CONVERSION = re.compile(r'%[-+ #0]*\d{0,3}(\.\d{0,3})?[sriduxXofFeEgGc%]')
# Of `math`, but what makes large whole numbers.
_NAMES: dict[str, Any] = {
    name: value
    for name, value in vars(math).items()
    if not name.startswith('_') and name not in ('comb', 'factorial', 'perm', 'prod')
}
_FAULTS = (ArithmeticError, LookupError, TypeError, ValueError, RecursionError, MemoryError)


@dataclass(frozen=True)
class _Scope:
    """What an expression can name.

    Attributes:
        names: The names with their values.
        takes: What it is made of, for messages.
        of_message: Whether there is a message with fields.
    """

    names: Mapping[str, Any]
    takes: str
    of_message: bool = False


_TAKES = 'numbers, texts, + - * / // % **, comparisons, in, and, or, not, if'
_CALLS = ', '.join(f'{name}()' for name in _FUNCTIONS)
_OF_LAUNCH = _Scope(_NAMES, f'{_TAKES}, the names of math, {_CALLS}')


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
    takes = f'm (the message) and its fields, {_TAKES}, {_CALLS}'

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
    known = (bool, int, float, str, type(None))
    if isinstance(node, ast.Constant) and isinstance(node.value, known):
        return node.value
    if isinstance(node, (ast.List, ast.Tuple, ast.Set)):
        items = [_value(item, scope) for item in node.elts]
        makes = {ast.List: list, ast.Tuple: tuple, ast.Set: set}
        return makes[type(node)](items)
    if isinstance(node, ast.Dict) and None not in node.keys:
        keys = [_value(key, scope) for key in node.keys if key is not None]
        return dict(zip(keys, (_value(value, scope) for value in node.values), strict=True))
    if isinstance(node, ast.JoinedStr) and not scope.of_message:
        return _formatted(node, scope)
    if isinstance(node, ast.Name):
        return _named(node.id, scope)
    if isinstance(node, ast.UnaryOp) and type(node.op) in _UNARY:
        return _UNARY[type(node.op)](_value(node.operand, scope))
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        return _joined(node.op, _value(node.left, scope), _value(node.right, scope))
    if isinstance(node, ast.BoolOp):
        return _any_or_all(node, scope)
    if isinstance(node, ast.IfExp):
        return _value(node.body if _value(node.test, scope) else node.orelse, scope)
    if isinstance(node, ast.Compare) and all(type(op) in _BINARY for op in node.ops):
        return _compared(node, scope)
    if isinstance(node, ast.Subscript):
        return _plain(_value(node.value, scope)[_index(node.slice, scope)])
    if isinstance(node, ast.Call) and not node.keywords:
        function = _function(node.func, scope)
        if function is not None:
            return _bounded(function(*(_value(each, scope) for each in node.args)))
    if isinstance(node, ast.Attribute) and scope.of_message:
        return _plain(_field(_value(node.value, scope), node.attr))
    if _is_of_math(node, scope):
        return scope.names[node.attr]  # type: ignore[attr-defined]
    raise LaunchError(
        f'{ast.unparse(node)} is not allowed in it.', todo=f'It takes {scope.takes}.'
    )


def _is_of_math(node: ast.expr, scope: _Scope) -> bool:
    """Return whether an expression is `math.pi` or another of its names."""
    return (
        isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == 'math'
        and not scope.of_message
        and node.attr in scope.names
    )


def _named(name: str, scope: _Scope) -> Any:
    if name in scope.names:
        return scope.names[name]
    meant = {'true': 'True', 'false': 'False'}.get(name, f"'{name}'")
    raise LaunchError(
        f'{name} is no name in it.',
        todo=f'Python writes {meant}.'
        if meant in ('True', 'False')
        else f'A text needs quotation marks: {meant}',
    )


def _formatted(node: ast.JoinedStr, scope: _Scope) -> str:
    """Return the text of an f-string without forms such as `:.2f`."""
    parts = []
    for part in node.values:
        if isinstance(part, ast.FormattedValue):
            if part.format_spec is not None or part.conversion != -1:
                raise LaunchError('An f-string has no forms after : and ! in it.')
            parts.append(str(_value(part.value, scope)))
        else:
            parts.append(str(_value(part, scope)))
    return str(_bounded(''.join(parts)))


def _compared(node: ast.Compare, scope: _Scope) -> bool:
    left = _value(node.left, scope)
    for op, comparator in zip(node.ops, node.comparators, strict=True):
        right = _value(comparator, scope)
        if not _BINARY[type(op)](left, right):
            return False
        left = right
    return True


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
    """Return a function, or a method of a text or a dictionary, that may be called."""
    if isinstance(node, ast.Name) and (node.id in _FUNCTIONS or not scope.of_message):
        found = _FUNCTIONS.get(node.id) or scope.names.get(node.id)
        return found if callable(found) else None
    if _is_of_math(node, scope):
        found = scope.names[node.attr]  # type: ignore[attr-defined]
        return found if callable(found) else None
    if isinstance(node, ast.Attribute):
        return _method(_value(node.value, scope), node.attr)
    return None


def _method(value: Any, name: str) -> Callable[..., Any] | None:
    if type(value) is dict and name == 'get':
        return value.get
    if type(value) is not str:
        return None
    if name == 'join':
        return lambda texts: _joined_by(value, texts)
    if name == 'replace':
        return lambda old, new: _replaced(value, old, new)
    method: Callable[..., Any] | None = getattr(value, name) if name in _OF_TEXTS else None
    return method


def _joined_by(sign: str, texts: Sequence[str]) -> str:
    _check_length(sum(len(sign) + len(text) for text in texts))
    return sign.join(texts)


def _replaced(text: str, old: str, new: str) -> str:
    _check_length(len(text) + text.count(old) * len(new))
    return text.replace(old, new)


def _check_length(length: int) -> None:
    if length > LONGEST:
        raise LaunchError(f'It would have more than {LONGEST} characters.')


def _bounded(value: Any) -> Any:
    """Return a value, unless it is too long."""
    if isinstance(value, int) and value.bit_length() > LONGEST:
        raise LaunchError('The number is too large.')
    if isinstance(value, (str, list, tuple)):
        _check_length(len(value))
    return value


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
        if isinstance(left, str) and '%' not in _CONVERSION.sub('', left):
            return _bounded(left % right)
        raise LaunchError('% takes numbers, or a text with conversions such as %d.')
    whole = isinstance(left, int) and isinstance(right, int)
    if isinstance(op, ast.Pow) and whole and left.bit_length() * abs(right) > LONGEST:
        raise LaunchError(f'{left} ** {right} is too large.')
    if isinstance(op, ast.LShift) and whole and left.bit_length() + right > LONGEST:
        raise LaunchError(f'{left} << {right} is too large.')
    if isinstance(op, ast.Mult) and not numbers:
        length = [one for one in (left, right) if not isinstance(one, (int, float))]
        times = [one for one in (left, right) if isinstance(one, int)]
        if length and times:
            _check_length(len(length[0]) * times[0])
    return _bounded(_BINARY[type(op)](left, right))
