"""Whether a node reads its parameters again, as its code says; none of it is run."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from types import CodeType, FunctionType, GetSetDescriptorType
from typing import Any

__all__ = ['reads_only_in_init']

# What reads parameters or follows them, and what sets them: then a new value is the node's own.
_NAMES = frozenset(
    (
        *('get_parameter', 'get_parameter_or', 'get_parameters', 'get_parameters_by_prefix'),
        *('declare_parameter', 'declare_parameters', 'set_parameters'),
        *('set_parameters_atomically', '_parameters', 'ParameterEventHandler', 'getattr'),
    )
)


def reads_only_in_init(kind: type, base: type, callbacks: Iterable[Any]) -> bool:
    """Return whether parameters are read in the `__init__` of a class and nowhere else.

    Args:
        kind: The class.
        base: What it is made on, which is not looked into: `Node`.
        callbacks: The callbacks of its object.
    """
    own = [each for each in kind.__mro__ if each not in base.__mro__]
    inits = [vars(each)['__init__'] for each in own if '__init__' in vars(each)]
    if any(each.__module__ != '__main__' for each in own):
        return False
    if any(type(init) is not FunctionType for init in inits):
        return False
    if not any(_NAMES & {*init.__code__.co_names} for init in inits):
        return False
    things = [*callbacks, *_helpers(base)]
    things += [thing for each in own for key, thing in vars(each).items() if key != '__init__']
    codes = [code for thing in things for code in _codes(thing)]
    codes += [code for init in inits for code in _within(init.__code__)]
    return not any(code is None or _NAMES & {*code.co_names} for code in codes)


def _helpers(base: type) -> Iterator[Any]:
    """Yield the functions of the notebook, and what its classes have that are no nodes."""
    for thing in list(vars(sys.modules['__main__']).values()):
        is_class = issubclass(type(thing), type)
        if not (is_class or type(thing) is FunctionType) or thing.__module__ != '__main__':
            continue
        if not is_class:
            yield thing
        elif not issubclass(thing, base):
            yield from vars(thing).values()


def _codes(thing: Any) -> Iterator[CodeType | None]:
    """Yield the code of a thing, None for what can't be looked into, nothing for plain data."""
    if isinstance(thing, property):
        yield from (code for each in (thing.fget, thing.fset) for code in _codes(each))
        return
    thing = getattr(thing, '__func__', thing)  # of a method
    if type(thing) is FunctionType:
        if {*thing.__code__.co_freevars} - {'__class__'}:
            yield None  # a decorator may have put another function around it
        yield thing.__code__
        yield from _within(thing.__code__)
    elif isinstance(thing, GetSetDescriptorType):
        return  # `__dict__` and `__weakref__`, which each class has
    elif callable(thing) or hasattr(type(thing), '__get__'):
        yield None


def _within(code: CodeType) -> Iterator[CodeType]:
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield inner
            yield from _within(inner)
