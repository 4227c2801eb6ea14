"""What the learner has made, where nothing of it is what the exercise asks for.

A learner who has written something and is told 'write your code' looks for the fault in the wrong
place. So a check that finds no attempt names what is new: a node of another name or topic, a class
that is defined and never used, a process that has ended.
"""

from __future__ import annotations

import ast
import contextlib
import linecache
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.exercises import common_mistakes
from labkit.exercises.callback_count import is_given
from labkit.exercises.expect import spinning
from labkit.exercises.learner_errors import last_cell
from labkit.exercises.machine_faults import refuse_machine_fault
from labkit.exercises.verdict import Fail
from labkit.exercises.what_is_asked import PUBLISHER, SERVICE, SUBSCRIPTION
from labkit.files import read_limited

if TYPE_CHECKING:
    from labkit.background.console import Cell
    from labkit.exercises.exercise import Exercise
    from labkit.exercises.probe import Probe

__all__ = ['definition', 'refuse_nameless', 'refuse_traces', 'replaced_class']

# Of a longer program the beginning is looked at, in characters.
MAX_PROGRAM = 100_000


def refuse_traces(probe: Probe, exercise: Exercise, task: str) -> None:
    """Raise Fail if the learner has made something that may be meant as an attempt.

    Args:
        probe: The probe of the check.
        exercise: The exercise.
        task: What it asks for, in a few words.
    """
    _refuse_ended_nodes(task)
    _refuse_nodes(probe, exercise, task)
    if settings.in_kernel():
        _refuse_class(task)
    _refuse_process(probe, task)
    if settings.in_kernel():
        _refuse_cell(exercise, task)


def refuse_nameless(probe: Probe, task: str) -> None:
    """Raise Fail if the graph has lost the name of a node that runs here.

    That is so if a node of the same name was destroyed, and somebody held it until the new one was
    made: then ROS takes what the new one has for the old one's, and forgets it with that.

    Args:
        probe: The probe of the check.
        task: What the exercise asks for, in a few words.

    Raises:
        LabError: Who holds it is a callback of it that still runs.
    """
    from labkit.background.runtime import runtime
    from labkit.rosgraph.snapshot import node_names

    spinning.earlier()
    known = node_names(probe.node)
    for entry in runtime.nodes():
        if entry.name in known or is_given(entry.name, probe.scope):
            continue
        raise Fail(
            task,
            f'the node {entry.name}, which runs here, and of which the graph has lost the name',
            common_mistakes.NAME_LOST,
        )


def _refuse_nodes(probe: Probe, exercise: Exercise, task: str) -> None:
    """Raise Fail if there is a node that does nothing this lesson knows, or is meant for this."""
    from labkit.background.runtime import runtime

    asked = {topic for _, topic in probe.scope.of_lesson}
    ends: dict[str, list[str]] = {name: [] for name in _own_nodes(probe)}
    known: set[str] = set()
    meant = {e.name for e in runtime.nodes() if _is_meant(e.cell, exercise)}
    for kind, found in (
        (PUBLISHER, probe.all_publishers()),
        (SUBSCRIPTION, probe.all_subscriptions()),
    ):
        for end in found:
            if end.node not in ends:
                continue
            word = 'publishes on' if kind == PUBLISHER else 'subscribes to'
            ends[end.node].append(f'{word} {end.topic} ({end.msg_type})')
            if end.node in meant:
                _refuse_kept_topic(exercise, task, end.node, (kind, end.topic), word)
            shown = end.topic in probe.scope.known and end.topic not in asked
            if shown or (kind, end.topic) in probe.scope.of_lesson:
                known.add(end.node)
    for server in probe.all_servers():
        if server.node in ends:
            ends[server.node].append(f'serves {server.service} ({server.srv_type})')
            if (SERVICE, server.service) in probe.scope.of_lesson:
                known.add(server.node)
    known.difference_update(e.name for e in runtime.nodes() if _is_of_starter(e.cell, exercise))
    new = {name: what for name, what in ends.items() if name not in known}
    if not new:
        return
    name, what = next(iter(new.items()))
    if name not in meant and settings.in_kernel():
        _refuse_class(task)
    other = f', and {len(new) - 1} more' if len(new) > 1 else ''
    raise Fail(
        task,
        f'the node {name}, which {", ".join(what) or "neither publishes nor subscribes"}{other}',
        common_mistakes.SOMETHING_ELSE.of(node=name),
    )


def _is_of_starter(cell: Cell, exercise: Exercise) -> bool:
    """Tell whether it is the cell to edit: what it has made is meant, whatever it does."""
    return cell.cell_id == exercise.starter_id


def _is_meant(cell: Cell, exercise: Exercise) -> bool:
    """Tell whether what a cell has made is meant for an exercise.

    That is so for the cell to edit, and for any that has run since another exercise was checked,
    if it is not the one of another exercise. It may be one of the lesson's, too.
    """
    if _is_of_starter(cell, exercise):
        return True
    lesson = exercise.belongs_to
    others = [other.starter_id for other in lesson.exercises] if lesson is not None else []
    since = last_cell.since_another_check(exercise.name)
    return cell.cell_id not in others and 0 < since <= cell.number


def _refuse_kept_topic(
    exercise: Exercise, task: str, node: str, role: tuple[str, str], does: str
) -> None:
    """Raise Fail if a node that is meant for this exercise has a role of an earlier one."""
    lesson = exercise.belongs_to
    wanted = next((topic for kind, topic in exercise.scope.own if kind == role[0]), '')
    if lesson is None or not wanted or role in exercise.scope.roles:
        return
    for number, other in enumerate(lesson.exercises, start=1):
        if role in other.scope.roles and role in exercise.scope.earlier:
            said = {'node': node, 'does': does, 'topic': role[1]}
            kept = common_mistakes.KEPT_TOPIC.of(number=number, wanted=wanted, **said)
            raise Fail(task, f'the node {node}, which {does} {role[1]}', kept)


def _refuse_cell(exercise: Exercise, task: str) -> None:
    """Raise Fail if the cell to edit has run with a whole program, of which nothing is there."""
    from labkit.settings import shell

    run = last_cell.run_of(exercise.starter_id)
    if run is None or run.error is not None:
        return
    try:
        tree = ast.parse(shell().user_ns['In'][run.number])
    except (LookupError, SyntaxError):
        return
    inside = list(ast.walk(tree))
    defined = [n for n in inside if isinstance(n, (ast.ClassDef, ast.FunctionDef))]
    if defined and not any(isinstance(n, ast.Constant) and n.value is ... for n in inside):
        raise Fail(task, 'the cell, which ran, and no node of it', common_mistakes.NOTHING_MADE)


def _refuse_ended_nodes(task: str) -> None:
    """Raise Fail if a callback has ended its own node."""
    from labkit.background.runtime import runtime

    for name, what in runtime.ended.items():
        raise Fail(
            task,
            f'no node: {name} has ended, because its callback {what}',
            common_mistakes.SHUT_DOWN,
        )


def _own_nodes(probe: Probe) -> list[str]:
    """Return the nodes of this notebook and of the processes that it has started."""
    return [name for name in dict.fromkeys(probe.node_names()) if probe.is_from_here(name)]


def _refuse_class(task: str) -> None:
    """Raise Fail if a class of nodes was written in the notebook, and no node was made of it."""
    names = [name for name, kind in _classes().items() if _is_written(kind)]
    if not names:
        return
    name = names[-1]
    raise Fail(
        task,
        f'the class {name}, and no node of it',
        common_mistakes.ONLY_A_CLASS.of(name=name),
    )


def _classes() -> dict[str, type]:
    """Return the classes of nodes that cells have defined, and of which none was ever made."""
    from rclpy.node import Node

    from labkit.background.nodes import existing_nodes, made

    used = {*made.kinds(), *map(type, existing_nodes())}
    used = {base for kind in used for base in kind.__mro__}
    space: dict[str, Any] = vars(sys.modules['__main__'])
    return {
        name: thing
        for name, thing in space.items()
        if type(thing) is type
        and issubclass(thing, Node)
        and thing.__module__ == '__main__'
        and thing not in used
        and not name.startswith('_')
    }


def replaced_class(kind: str, topic: str) -> str:
    """Return a class of the notebook that makes such an end, and whose nodes have all ended.

    Args:
        kind: `'publisher'` or `'subscription'`.
        topic: Full name of the topic.

    Returns:
        Its name; `''` if there is none.
    """
    from labkit.background.nodes import existing_nodes, made

    space, alive = vars(sys.modules['__main__']), {*map(type, existing_nodes())}
    # What another cell, or another run of this one, has made is no part of this attempt.
    cells = {_cell_of(each) for each in alive} - {''}
    for each in made.kinds() if settings.in_kernel() else ():
        here = space.get(each.__name__) is each and _cell_of(each) in cells
        if not here or each in alive:
            continue
        written = definition(each)
        if written is not None and _makes(ast.unparse(written), kind, topic):
            return str(each.__name__)
    return ''


def _is_written(kind: type) -> bool:
    """Tell whether nothing of a class is left open: three dots stand where a learner writes."""
    written = definition(kind)
    inside = list(ast.walk(written)) if written is not None else []
    open_ends = [node for node in inside if isinstance(node, ast.Constant) and node.value is ...]
    return bool(inside) and not open_ends


def _cell_of(kind: type) -> str:
    """Return the name of the file that holds the code of a class of the notebook, or `''`."""
    functions = [thing for thing in vars(kind).values() if isinstance(thing, FunctionType)]
    is_own = kind.__module__ == '__main__' and functions
    return functions[0].__code__.co_filename if is_own else ''


def definition(kind: type) -> ast.ClassDef | None:
    """Return what a cell says of a class, None if that cannot be read."""
    functions = [thing for thing in vars(kind).values() if isinstance(thing, FunctionType)]
    if not functions:
        return None
    lines = linecache.getlines(functions[0].__code__.co_filename)
    try:
        tree = ast.parse(''.join(lines))
    except SyntaxError:  # it has lines for IPython, such as those that begin with %
        return None
    found = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef) and node.name == kind.__name__
    ]
    return found[-1] if found else None


def _refuse_process(probe: Probe, task: str) -> None:
    """Raise Fail if a process that this notebook has started for this exercise is over."""
    from labkit.programs.children import ended_children

    for child in ended_children():
        # The lesson and other exercises have processes that have ended, too.
        if not _may_mean(probe, _program(child.command)):
            continue
        refuse_machine_fault((), child.exit_code)
        code = f' with exit code {child.exit_code}' if child.exit_code else ''
        raise Fail(
            task,
            f'a process that this notebook has started, and that has ended{code}',
            common_mistakes.PROCESS_ENDED,
        )


def _may_mean(probe: Probe, program: str) -> bool:
    """Tell whether a program works with a topic of this exercise, and in its way.

    Where earlier exercises ask for all of its roles, it is none that has another role of these.
    """
    scope = probe.scope
    earlier = {topic for _, topic in scope.earlier}
    new = any(topic not in earlier for topic in scope.topics)
    others = scope.earlier - scope.roles.keys() if scope.roles.keys() <= scope.earlier else ()
    if any(_makes(program, kind, topic) for kind, topic in others):
        return False
    return any(
        topic.lstrip('/') in program
        and (topic not in earlier if new else _makes(program, kind, topic))
        for kind, topic in scope.own
    )


def _makes(program: str, kind: str, topic: str) -> bool:
    """Tell whether a program makes such an end of a topic, by a call that names it."""
    name = re.escape(topic.lstrip('/'))
    return re.search(rf'_{kind}\([^()]*["\']/?{name}["\']', program) is not None


def _program(command: Sequence[str]) -> str:
    """Return the text of a program, as far as it can be had from its command."""
    texts = list(command)
    for word in command:
        path = Path(word) if word.endswith('.py') else None
        if path is not None and path.is_file():
            with contextlib.suppress(OSError):
                texts.append(read_limited(path).decode(errors='replace')[:MAX_PROGRAM])
    return '\n'.join(texts)
