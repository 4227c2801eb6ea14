"""Answers to `squares`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong('another topic', "Write the name as '/squares'"),
    wrong(
        'not ended', 'without saying how the goal ended', ('        goal_handle.succeed()\n', '')
    ),
    wrong(
        'aborted on purpose',
        'execute_callback said abort()',
        ('goal_handle.succeed()', 'goal_handle.abort()'),
    ),
    wrong(
        'an error, in a process of its own',
        'execute_callback raised an error',
        ('request.order', 'request.count'),
        run='process',
    ),
    wrong(
        'the first ten only',
        'result = 8 alike, then 64, 81, 100',
        ('range(goal_handle.request.order)', 'range(min(goal_handle.request.order, 10))'),
    ),
    wrong(
        'none gives one',
        'result = none for order = 0',
        ('(goal_handle', '(max(1, goal_handle'),
        ('order):', 'order)):'),
    ),
    wrong('from 1 on', 'The numbers are not those of the task.', ('i * i', '(i + 1) ** 2')),
    wrong('cubes', 'The numbers are not those of the task.', ('i * i', 'i**3')),
    wrong('one too many', 'result = ', ('request.order)', 'request.order + 1)')),
    wrong(
        'an empty result',
        'The result is empty.',
        ('return Fibonacci.Result(sequence=numbers)', 'return Fibonacci.Result()'),
    ),
    wrong(
        'numbers that stay',
        'The numbers of the goal before are still there.',
        ('        numbers = []\n', '        numbers = self.numbers\n'),
        ("__init__('squares')\n", "__init__('squares')\n        self.numbers = []\n"),
    ),
    wrong(
        'a field that does not exist',
        'AttributeError',
        ('request.order', 'request.count'),
        outcome=ERROR,
    ),
    right('functions'),
    right('async', ('    def execute', '    async def execute')),
    right('own process, several threads', run='process'),
]
