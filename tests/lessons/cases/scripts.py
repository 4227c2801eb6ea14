"""A solution as a script, which every check must accept, started in one way or another."""

from __future__ import annotations

from collections.abc import Callable, Mapping

__all__ = ['RUNS']


def in_process(code: str) -> str:
    """Return a solution as a script for a process of its own.

    Args:
        code: The solution. Two empty lines stand before its last lines, which start the node.
            What starts none by `lab.spin()` is a script already.

    Raises:
        ValueError: These lines do not start one node.
    """
    if 'lab.spin(' not in code:
        return code
    body, node = _parts(code)
    return _script(body, f'rclpy.spin({node})')


def two_copies(code: str) -> str:
    """Return a solution as a script that makes its node twice. Arguments as for `in_process`."""
    body, node = _parts(code)
    return _script(body, f'copies = {node}, {node}', 'rclpy.spin(copies[0])')


def started_by_subprocess(script: str) -> str:
    """Return a cell that starts a script as a process, as the standard library does it."""
    start = "process = subprocess.Popen([sys.executable, '-c', program])"
    return f'import subprocess\nimport sys\n\nprogram = {_quoted(script)}\n{start}\n'


def started_by_asyncio(script: str) -> str:
    """Return a cell that starts a script as a process without waiting, as asyncio does it."""
    start = "process = await asyncio.create_subprocess_exec(sys.executable, '-c', program)"
    return f'import asyncio\nimport sys\n\nprogram = {_quoted(script)}\n{start}\n'


def _quoted(script: str) -> str:
    quotes = "'''" if '"""' in script else '"""'
    return f'{quotes}{script}{quotes}'


def _parts(code: str) -> tuple[str, str]:
    """Return what stands before the lines that start the node, and what makes the node."""
    body, _, start = code.strip().rpartition('\n\n\n')
    if start.count('lab.spin(') != 1:
        raise ValueError(f'Not one node is started in:\n{start}')
    return body, start.partition('lab.spin(')[2].rpartition(')')[0]


def _script(body: str, *lines: str) -> str:
    before = body.splitlines()
    first = next(i for i, line in enumerate(before) if line.startswith('from '))
    before.insert(first, 'import rclpy')
    main = [f'    {line}' for line in ('rclpy.init()', *lines)]
    return '\n'.join([*before, '', '', 'def main():', *main, '', '', 'main()', ''])


RUNS: Mapping[str, Callable[[str], str]] = {
    'process': in_process,
    'two copies': two_copies,
    'subprocess': lambda code: started_by_subprocess(in_process(code)),
    'asyncio': lambda code: started_by_asyncio(in_process(code)),
}
