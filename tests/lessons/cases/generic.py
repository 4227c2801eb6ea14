"""Answers that every exercise has whose solution spins a node: made from that solution.

A row of an exercise's table that has the name of one, and no changes, says what becomes of it
there: another sentence, or that it is right.
"""

from __future__ import annotations

import ast
import functools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from mutants.changes import bodies, misspelt
from mutants.ros_changes import ros_changes

from cases.styles import callbacks_otherwise, composed, own_executor
from labkit.exercises import Exercise, Outcome

__all__ = ['KINDS', 'Kind', 'generated', 'usual']

# Which argument of a call is the name of a topic, service or action.
_NAME_AT = {
    **dict.fromkeys(('create_publisher', 'create_subscription'), 1),
    **dict.fromkeys(('create_service', 'create_client'), 1),
    **dict.fromkeys(('ActionServer', 'ActionClient'), 2),
}


@dataclass(frozen=True)
class Kind:
    """A change that can be made to each solution, or a way to start it.

    Attributes:
        change: Makes it, and gives nothing where there is nothing to change.
        outcome: What it gets, if the table of the exercise does not say otherwise.
        says: What the verdict must contain then.
        run: How it is started, see `cases.right`.
    """

    change: Callable[[str], Iterator[str]]
    outcome: Outcome = Outcome.FAIL
    says: str = ''
    run: str = ''


def generated(name: str, exercise: Exercise) -> str | None:
    """Return what a kind makes of the solution of an exercise, None if it has no place there."""
    code = exercise.answer.code
    if name not in KINDS or not exercise.answer.name.endswith('.py'):
        return None
    if 'lab.spin(' not in code.rstrip().rpartition('\n')[2]:
        return None
    return next(KINDS[name].change(code), None)


def usual(name: str, exercise: Exercise) -> tuple[Outcome, str]:
    """Return what a kind gets, and what the verdict contains, if the table says nothing."""
    if name == 'another node name' and not exercise.nodes:
        return Outcome.PASS, ''
    return KINDS[name].outcome, KINDS[name].says


def _mutant(kind: str) -> Callable[[str], Iterator[str]]:
    """Return the first one of those mutants of a program that are of one kind."""
    return lambda code: (mutant for name, mutant in _mutants(code) if name == kind)


@functools.cache
def _mutants(code: str) -> list[tuple[str, str]]:
    return list(ros_changes(code))


def _renamed(change: Callable[[str], str]) -> Callable[[str], Iterator[str]]:
    def renamed(code: str) -> Iterator[str]:
        tree = ast.parse(code)
        for function, place in _NAME_AT.items():
            for call in _calls(tree, function):
                name = call.args[place] if len(call.args) > place else None
                if isinstance(name, ast.Constant):
                    name.value = change(str(name.value))
                    yield ast.unparse(tree)

    return renamed


def _node_renamed(code: str) -> Iterator[str]:
    tree = ast.parse(code)
    for call in _calls(tree, '__init__', 'Node'):
        if call.args and isinstance(call.args[0], ast.Constant):
            call.args[0].value = misspelt(str(call.args[0].value))
            yield ast.unparse(tree)


def _in_a_namespace(code: str) -> Iterator[str]:
    tree = ast.parse(code)
    for call in _calls(tree, '__init__', 'Node'):
        if call.args:
            call.keywords.append(ast.keyword('namespace', ast.Constant('my_own')))
            yield ast.unparse(tree)


def _publishes_twice(code: str) -> Iterator[str]:
    tree = ast.parse(code)
    for body in bodies(tree):
        for i, statement in enumerate(body):
            if isinstance(statement, ast.Expr) and '.publish(' in ast.unparse(statement):
                body.insert(i, statement)
                yield ast.unparse(tree)


def _self_forgotten(code: str) -> Iterator[str]:
    """Give the program with something kept in a variable that is used elsewhere."""
    tree = ast.parse(code)
    used = [n for n in ast.walk(tree) if isinstance(n, ast.Attribute)]
    used = [n for n in used if isinstance(n.ctx, ast.Load) and ast.unparse(n.value) == 'self']
    for statement in ast.walk(tree):
        if isinstance(statement, ast.Assign) and 'self.create_' in ast.unparse(statement.value):
            target = statement.targets[0]
            if isinstance(target, ast.Attribute) and target.attr in {n.attr for n in used}:
                statement.targets[0] = ast.Name(target.attr, ast.Store())
                yield ast.unparse(tree)


def _as_it_is(code: str) -> Iterator[str]:
    """Give the program, if what it starts at its end is one node.

    One that does something as it ends would need more than that in a process of its own.
    """
    if code.rpartition('\n\n\n')[2].count('lab.spin(') == 1 and 'def destroy_node' not in code:
        yield code


def _calls(tree: ast.AST, *names: str) -> list[ast.Call]:
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return [c for c in calls if getattr(c.func, 'attr', getattr(c.func, 'id', '')) in names]


def _capital(name: str) -> str:
    first = next(i for i, letter in enumerate(name) if letter.isalpha())
    return name[:first] + name[first].upper() + name[first + 1 :]


KINDS: Mapping[str, Kind] = {
    'not spun': Kind(_mutant('not-spun'), says='lab.spin(node)'),
    'another topic': Kind(_renamed(misspelt)),
    'capital letter': Kind(_renamed(_capital), says='Capital and small letters differ'),
    'another node name': Kind(_node_renamed, says='The name is what Node() gets'),
    'wrong type': Kind(_mutant('type'), says='A topic carries one type of message.'),
    'publishes twice': Kind(_publishes_twice),
    'callback called': Kind(_mutant('called'), Outcome.ERROR),
    'self forgotten': Kind(_self_forgotten, Outcome.ERROR, 'has nothing called'),
    'in a namespace': Kind(_in_a_namespace),
    'callbacks in other forms': Kind(callbacks_otherwise, Outcome.PASS),
    'composition, and names remapped': Kind(composed, Outcome.PASS),
    'an executor of its own, and a helper': Kind(own_executor, Outcome.PASS),
    'own process': Kind(_as_it_is, Outcome.PASS, run='process'),
    'own process, by subprocess': Kind(_as_it_is, Outcome.PASS, run='subprocess'),
    'own process, by asyncio': Kind(_as_it_is, Outcome.PASS, run='asyncio'),
}
