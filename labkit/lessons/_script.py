"""A solution as a script, which every check must accept, started in this way or another."""

from __future__ import annotations

__all__ = ['in_process', 'started_by_asyncio', 'started_by_subprocess', 'two_copies']


def in_process(code: str) -> str:
    """Return a solution as a script for a process of its own.

    Args:
        code: The solution. Two empty lines stand before its last lines, which start the node.

    Raises:
        ValueError: These lines do not start one node.
    """
    body, node = _parts(code)
    return _script(body, f'rclpy.spin({node})')


def two_copies(code: str) -> str:
    """Return a solution as a script that makes its node twice. Arguments as for `in_process`."""
    body, node = _parts(code)
    return _script(body, f'copies = {node}, {node}', 'rclpy.spin(copies[0])')


def started_by_subprocess(script: str) -> str:
    """Return a cell that starts a script as a process, as the standard library does it."""
    start = "process = subprocess.Popen([sys.executable, '-c', program])"
    return f'import subprocess\nimport sys\n\nprogram = """{script}"""\n{start}\n'


def started_by_asyncio(script: str) -> str:
    """Return a cell that starts a script as a process without waiting, as asyncio does it."""
    start = "process = await asyncio.create_subprocess_exec(sys.executable, '-c', program)"
    return f'import asyncio\nimport sys\n\nprogram = """{script}"""\n{start}\n'


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
