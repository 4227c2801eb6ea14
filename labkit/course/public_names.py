"""Write docs/api.md: the public names of labkit, from their docstrings.

The code is parsed, not run: that needs no environment and starts no ROS.
"""

from __future__ import annotations

import ast
import contextlib
import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

from labkit.files import write_atomically
from labkit.setup.environment import ROOT

__all__ = ['FAULTS', 'PAGE', 'PublicName', 'page', 'public_names', 'write_page']

PAGE = ROOT / 'docs' / 'api.md'
FAULTS = ROOT / 'docs' / 'faults.md'
_HEAD = """\
<!-- Made by `python3 -m labkit docs` from the docstrings in the code. -->
# Public names of labkit

In a notebook: `import labkit as lab`. Tab and Shift-Tab show the same.
"""
_SECTIONS = ('Args', 'Attributes', 'Returns', 'Raises')
_WIDTH = 88

_Definition = ast.FunctionDef | ast.ClassDef


@dataclass(frozen=True)
class PublicName:
    """A public name, as described by its definition in the code.

    Attributes:
        module: The module that defines it.
        parameters: Each parameter as written, with `*` where only keywords follow.
        returns: The return annotation; `''` for a class.
        sections: The docstring: its prose under `''`, then sections by title.
    """

    name: str
    module: str
    parameters: tuple[str, ...]
    returns: str
    sections: dict[str, str]

    @property
    def signature(self) -> str:
        """The call as written in the code, on several lines if it is long."""
        arrow = f' -> {self.returns}' if self.returns else ''
        line = f'lab.{self.name}({", ".join(self.parameters)}){arrow}'
        if len(line) <= _WIDTH:
            return line
        inner = ''.join(f'    {parameter},\n' for parameter in self.parameters)
        return f'lab.{self.name}(\n{inner}){arrow}'

    def problems(self) -> list[str]:
        """Return what its docstring lacks, or says about parameters that do not exist."""
        if not self.sections['']:
            return [f'{self.name} has no docstring']
        written = {re.split('[:=]', parameter)[0].strip(' *') for parameter in self.parameters}
        taken = written - {''}  # a lone star
        described = {name.strip('*') for name, _ in _items(self.sections.get('Args', ''))}
        found = [f'{self.name} does not describe {name}' for name in sorted(taken - described)]
        found += [f'{self.name} has no {name}' for name in sorted(described - taken)]
        told = 'Returns' in self.sections or self.sections[''].startswith('Return ')
        if self.returns not in ('', 'None') and not told:
            found.append(f'{self.name} does not say what it returns')
        return found


def public_names(root: Path = ROOT) -> list[PublicName]:
    """Return the names in `labkit.__all__`, in its order.

    Args:
        root: The folder with the package.

    Raises:
        LookupError: One of them is not imported in labkit/__init__.py, or not defined.
    """
    names = next(
        ast.literal_eval(node.value)
        for node in _parse(root, 'labkit').body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == '__all__'
    )
    return [_read(root, 'labkit', name) for name in names]


def page(names: list[PublicName]) -> str:
    """Return the page with some names.

    Args:
        names: The result of `public_names`.
    """
    # The anchors are those that GitHub and JupyterLab's Markdown make of the headings.
    rows = [
        f'| [`lab.{one.name}`](#lab{one.name.lower()}) | {one.sections[""].splitlines()[0]} |'
        for one in names
    ]
    return '\n'.join([_HEAD, '| name | what it is |', '|---|---|', *rows, *map(_entry, names)])


def write_page() -> str:
    """Update docs/api.md, and docs/faults.md from the silent faults.

    Returns:
        A sentence about each result.
    """
    from labkit.silent.catalogue import page as page_of_faults

    pages = {PAGE: page(public_names()), FAULTS: page_of_faults()}
    return '\n'.join(_write(path, text.encode()) for path, text in pages.items())


def _write(path: Path, content: bytes) -> str:
    if path.is_file() and path.read_bytes() == content:
        return f'{path} is up to date.'
    path.parent.mkdir(exist_ok=True)
    write_atomically(path, content)
    return f'{path} is written anew.'


# --- Reading the code ----------------------------------------------------------------------------


def _parse(root: Path, module: str) -> ast.Module:
    path = root.joinpath(*module.split('.'))
    path = path / '__init__.py' if path.is_dir() else path.with_suffix('.py')
    return ast.parse(path.read_text(encoding='utf-8'))


def _read(root: Path, module: str, name: str) -> PublicName:
    """Return a name that a module defines or imports."""
    tree = _parse(root, module)
    for node in tree.body:
        if isinstance(node, _Definition) and node.name == name:
            return _described(node, module, root)
    for inner in ast.walk(tree):
        if isinstance(inner, ast.ImportFrom) and name in [alias.name for alias in inner.names]:
            return _read(root, str(inner.module), name)
    raise LookupError(f'{module} neither defines {name} nor imports it')


def _described(node: _Definition, module: str, root: Path) -> PublicName:
    sections = _sections(ast.get_docstring(node) or '')
    if isinstance(node, ast.FunctionDef):
        returns = ast.unparse(node.returns) if node.returns else ''
        return PublicName(node.name, module, _parameters(node.args), returns, sections)
    for inner in node.body:
        if isinstance(inner, ast.FunctionDef) and inner.name == '__init__':
            words = _parameters(inner.args)[1:]
            return PublicName(node.name, module, words, '', sections)
    for base in node.bases:
        # It inherits the constructor of its base, with the docstring.
        with contextlib.suppress(LookupError):
            above = _read(root, module, ast.unparse(base))
            sections = {'Args': above.sections.get('Args', ''), **sections}
            return PublicName(node.name, module, above.parameters, '', sections)
    return PublicName(node.name, module, (), '', sections)


def _parameters(arguments: ast.arguments) -> tuple[str, ...]:
    """Return each parameter as written."""
    plain = [*arguments.posonlyargs, *arguments.args]
    defaults = [None] * (len(plain) - len(arguments.defaults)) + [*arguments.defaults]
    found = [_parameter(one, value) for one, value in zip(plain, defaults, strict=True)]
    if arguments.vararg:
        found.append(f'*{_parameter(arguments.vararg)}')
    elif arguments.kwonlyargs:
        found.append('*')
    pairs = zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    found += [_parameter(one, value) for one, value in pairs]
    if arguments.kwarg:
        found.append(f'**{_parameter(arguments.kwarg)}')
    return tuple(found)


def _parameter(one: ast.arg, default: ast.expr | None = None) -> str:
    text = f'{one.arg}: {ast.unparse(one.annotation)}' if one.annotation else one.arg
    return f'{text} = {ast.unparse(default)}' if default else text


def _sections(docstring: str) -> dict[str, str]:
    """Return the parts of a Google docstring; the prose before the first section under `''`."""
    found = {'': ''}
    title = ''
    for line in docstring.splitlines():
        if line.endswith(':') and line[:-1] in _SECTIONS:
            title = line[:-1]
            found[title] = ''
        else:
            found[title] += f'{line}\n'
    return {title: textwrap.dedent(text).strip() for title, text in found.items()}


# --- Writing the page ----------------------------------------------------------------------------


def _items(section: str) -> list[tuple[str, str]]:
    """Return name and text of each item in a section such as Args."""
    found = re.findall(r'^(\*{0,2}\w+(?: \(.*?\))?): *(.*(?:\n +.*)*)', section, re.MULTILINE)
    return [(name, ' '.join(text.split())) for name, text in found]


def _entry(one: PublicName) -> str:
    lines = ['', f'## lab.{one.name}', '', '```python', one.signature, '```', '']
    lines.append(one.sections[''])
    for title in _SECTIONS:
        text = one.sections.get(title, '')
        if title == 'Returns' and text:
            lines += ['', f'**{title}** {" ".join(text.split())}']
        elif text:
            lines += ['', f'**{title}**', '']
            lines += [f'- `{name}`: {words}' for name, words in _items(text)]
    return '\n'.join([*lines, ''])
