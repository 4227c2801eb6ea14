"""What an editor and the Tab key tell of labkit: names, signatures, what never returns."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jedi
import pytest

import labkit

ROOT = Path(labkit.__file__).parent


def test_public_names_have_one_home_each_for_python_and_for_editors() -> None:
    homes = {**labkit._HOMES, 'LabError': 'labkit.errors', 'LabTimeout': 'labkit.errors'}
    assert sorted(labkit.__all__) == sorted(homes)
    tree = ast.parse((ROOT / '__init__.py').read_text(encoding='utf-8'))
    typed = {
        alias.name: str(node.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert {name: typed.get(name) for name in homes} == homes
    assert (ROOT / 'py.typed').is_file()


@pytest.mark.parametrize('name', sorted(set(labkit.__all__) - {'LabError', 'LabTimeout'}))
def test_an_editor_shows_signature_and_documentation(name: str) -> None:
    code = f'import labkit as lab\nlab.{name}('
    (signature,) = jedi.Script(code, path=ROOT.parent / 'cell.py').get_signatures()
    real = getattr(labkit, name)
    shown = [parameter.name for parameter in signature.params]
    assert shown == [key for key in inspect.signature(real).parameters if key != 'self']
    assert (inspect.getdoc(real) or 'nothing').splitlines()[0] in signature.docstring()


def test_jupyterlab_shows_signature_and_documentation(kernel: Any) -> None:
    kernel.run('import labkit as lab')
    told = kernel.inspect('node = lab.spin(')
    assert 'Run a node in the background' in told
    assert 'Signature:' in told and 'lab.spin(node' in told


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Return all functions of a piece of code."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield node


def never_returns(function: ast.AST) -> bool:
    """Tell whether a function ends in a raise and has no other way out."""
    body = list(getattr(function, 'body', ()))
    inner = [node for part in body for node in walk_own(part)]
    leaves = any(isinstance(node, (ast.Return, ast.Yield, ast.YieldFrom)) for node in inner)
    return bool(body) and isinstance(body[-1], ast.Raise) and not leaves


def walk_own(node: ast.AST) -> Iterator[ast.AST]:
    """Return the parts of a function's code, without those of functions inside it."""
    yield node
    if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
        for child in ast.iter_child_nodes(node):
            yield from walk_own(child)


@pytest.mark.slow('calls each public name')
def test_what_always_raises_says_so() -> None:
    silent = []
    for path in sorted(ROOT.rglob('*.py')):
        for function in functions(ast.parse(path.read_text(encoding='utf-8'))):
            returns = ast.unparse(function.returns) if function.returns else ''
            # A method that others override only says what they return.
            only_raises = 'NotImplementedError' in ast.unparse(function.body[-1])
            if never_returns(function) and not only_raises and returns != 'NoReturn':
                silent.append(f'{path.relative_to(ROOT)}: {function.name} -> {returns}')
    assert not silent, '\n'.join(silent)


@pytest.mark.parametrize(
    ('code', 'expected'),
    [
        ('def f():\n    raise ValueError', True),
        ('def f():\n    if x:\n        return 1\n    raise ValueError', False),
        ('def f():\n    def g():\n        return 1\n    raise ValueError', True),
        ('def f():\n    return 1', False),
    ],
)
def test_what_always_raises_would_be_found(code: str, expected: bool) -> None:
    (function, *_) = functions(ast.parse(code))
    assert never_returns(function) == expected
