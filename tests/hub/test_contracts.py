"""What the hub's classes replace of JupyterHub's takes all that the pinned version hands over."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import pytest
from jupyterhub.handlers import LoginHandler

from labkit.hub.login import ClassAuthenticator
from labkit.hub.spawner import GroupSpawner, LimitedSpawner

PAGES = [page for _, page in ClassAuthenticator().get_handlers(None)]


@pytest.mark.parametrize('cls', [*PAGES, ClassAuthenticator, LimitedSpawner, GroupSpawner])
def test_what_is_replaced_takes_what_it_is_called_with(cls: type) -> None:
    replaced = {
        f'{owner.__qualname__}.{name}': (own, above)
        for place, owner in enumerate(cls.__mro__)
        if owner.__module__.partition('.')[0] not in ('jupyterhub', 'tornado', 'builtins')
        for name, own in vars(owner).items()
        if inspect.isfunction(own) and name != '__init__'
        if inspect.isfunction(above := inherited(cls, place, name))
    }
    assert replaced or cls is LoginHandler
    wrong = {name: lacking for name, pair in replaced.items() if (lacking := lacks(*pair))}
    assert not wrong, wrong


def inherited(cls: type, place: int, name: str) -> Any:
    """Return what the classes above have by a name, None for nothing."""
    found = (vars(owner)[name] for owner in cls.__mro__[place + 1 :] if name in vars(owner))
    return next((one for one in found if one.__name__ != '_unimplemented_method'), None)


def lacks(own: Callable[..., Any], above: Callable[..., Any]) -> str:
    """Return what a function does not take that the one above takes, '' for nothing."""
    takes = inspect.signature(own).parameters
    kinds = {parameter.kind for parameter in takes.values()}
    for name, parameter in inspect.signature(above).parameters.items():
        fits = name in takes or parameter.kind in kinds
        if not fits and inspect.Parameter.VAR_KEYWORD not in kinds:
            return str(parameter)
    is_async = inspect.iscoroutinefunction(above)
    return 'async' if is_async and not inspect.iscoroutinefunction(own) else ''


def test_a_function_that_takes_less_is_found() -> None:
    """As the login page of jupyterhub-firstuseauthenticator does, of which none is used here."""

    def above(self: object, error: str = '', **more: object) -> None: ...
    def less(self: object, error: str = '') -> None: ...
    def as_much(self: object, error: str = '', **more: object) -> None: ...

    assert lacks(less, above).startswith('**more')
    assert lacks(as_much, above) == ''
