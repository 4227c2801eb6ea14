"""Shorten tracebacks to the learner's own lines.

An error inside ROS, or the stop button while a cell waits, would otherwise show pages of code that
the learner has not written.
"""

from __future__ import annotations

import ast
import importlib.util
import linecache
import os
import re
import sys
import sysconfig
import threading
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import Any

import rclpy
import rclpy.node
from rclpy.exceptions import InvalidHandle

from labkit.errors import LabError, cell_name

__all__ = [
    'argument_at_caller',
    'install',
    'is_learners',
    'short_traceback',
    'without_ros',
]

_LABKIT = os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + os.sep
_RCLPY = os.path.dirname(os.path.abspath(rclpy.__file__)) + os.sep
# A foreign kernel may have packages in one folder, and ROS in another.
_LIBRARIES = (
    *(sysconfig.get_path('stdlib'), sysconfig.get_path('purelib')),
    os.path.dirname(os.path.dirname(_RCLPY)),
)
_WITH_INIT = """
This is written for a newer release of ROS 2. On Jazzy, rclpy.init() returns nothing, so it can not
stand after `with`. Write instead:
    rclpy.init(args=args)
    ...
    rclpy.shutdown()"""
_TAKEN = """
rclpy uses the name {name} in each node for a thing of its own. Choose another name, such as
self.my_{name}."""
_ON_THE_CLASS = """
An earlier cell has set {name} on the class {kind} itself, as after msg = {kind} without brackets.
That is undone now. Write msg = {kind}(), and run this cell again."""
_NOT_YET = """
This {kind} is not a node yet: its __init__ has not called the one of Node. Let
super().__init__('name_of_the_node') be the first line of its __init__."""
_IN_A_LOOP = """
A cell runs in an event loop already. Write there, outside of any function, await and the
coroutine: await spin_for_a_while(node) instead of asyncio.run(spin_for_a_while(node))."""
_DESTROYED = """
This {kind} exists no more: it was destroyed, as all parts of a node are with their node: by
destroy_node(), when its cell is run again, or when ROS is stopped. Use one that exists, and let no
callback or thread keep the old one."""
# A round of up to so many functions that call each other is folded from more rounds than these on.
_LONGEST_ROUND, _SHOWN_ROUNDS = 8, 3
# Generated modules of interfaces: std_msgs/msg/_int16.py
_INTERFACES = tuple(f'{os.sep}{kind}{os.sep}_' for kind in ('msg', 'srv', 'action'))


def short_traceback(error: BaseException) -> str:
    """Return the learner's lines of a traceback, and the message."""
    calls = []
    for frame, number in traceback.walk_tb(error.__traceback__):
        name = frame.f_code.co_filename
        if not is_learners(name):
            continue
        call = f'  {cell_name(name) or name}, line {number}, in {frame.f_code.co_name}'
        source = linecache.getline(name, number).strip()
        calls.append(f'{call}\n    {source}' if source else call)
    lines = list(_folded(calls))
    if isinstance(error, LabError):
        return '\n'.join([*lines, f'{type(error).__name__}: {error}'])
    said = map(str.rstrip, _said(error))
    return '\n'.join([*lines, *said, *map(str.strip, _hint(error, error.__traceback__))])


def _said(error: BaseException) -> list[str]:
    """Return what Python says of an error, with the cell in place of its file."""
    said = traceback.format_exception_only(error)
    if isinstance(error, SyntaxError) and said[0].lstrip().startswith('File "'):
        # What splits a cell into words does not know where these come from.
        cell = cell_name(error.filename or '') or 'Cell' * (error.filename == '<tokenize>')
        said[0] = f'  {cell}, line {error.lineno}\n' if cell else said[0]
    if 'incompatible function arguments.' in said[-1]:
        # What follows is about the types of C++.
        said[-1] = said[-1].partition(' The following argument types')[0]
    return said


def _folded(calls: list[str]) -> Iterator[str]:
    """Yield calls without what follows itself again and again, as functions that call each other.

    The first round of it stays, as does what comes before and after.
    """
    at = 0
    while at < len(calls):
        for size in range(1, _LONGEST_ROUND + 1):
            first = calls[at : at + size]
            rounds = 1
            while calls[at + rounds * size : at + (rounds + 1) * size] == first:
                rounds += 1
            if rounds > _SHOWN_ROUNDS:
                yield from first
                yield f'  ... and so on, {rounds - 1} times more'
                at += rounds * size
                break
        else:
            yield calls[at]
            at += 1


def is_learners(filename: str) -> bool:
    """Return whether a file is a cell or the learner's own."""
    if cell_name(filename):
        return True
    path = os.path.abspath(filename)
    return not path.startswith((*_LIBRARIES, _LABKIT)) and os.path.exists(path)


def argument_at_caller(function: str, position: int, name: str) -> ast.expr | None:
    """Return an argument as the learner's line has it that calls a function; None if unknown."""
    for part, line in _around_caller():
        if not (isinstance(part, ast.Call) and part.lineno <= line <= (part.end_lineno or 0)):
            continue
        called = getattr(part.func, 'attr', '') or getattr(part.func, 'id', '')
        if called == function:
            named = {keyword.arg: keyword.value for keyword in part.keywords}
            return named.get(name, part.args[position] if len(part.args) > position else None)
    return None


def _around_caller() -> Iterator[tuple[ast.AST, int]]:
    """Yield all parts of the learner's code on the stack, with the line that is run there."""
    frame: FrameType | None = sys._getframe(2)
    while frame is not None:
        name = frame.f_code.co_filename
        if is_learners(name):
            with suppress(SyntaxError):
                for part in ast.walk(ast.parse(''.join(linecache.getlines(name)))):
                    yield part, frame.f_lineno
        frame = frame.f_back


def without_ros(tb: TracebackType | None) -> TracebackType | None:
    """Return a traceback without labkit, ROS and their libraries, but with all callbacks."""
    kept = []
    inside = False
    while tb is not None:
        name = tb.tb_frame.f_code.co_filename
        inside = not is_learners(name) and (inside or _is_ros(name))
        if not inside:
            kept.append(tb)
        tb = tb.tb_next
    result: TracebackType | None = None
    for entry in reversed(kept):
        result = TracebackType(result, entry.tb_frame, entry.tb_lasti, entry.tb_lineno)
    return result


def install(
    shell: Any,
    last_words: Callable[[BaseException], str],
    uncaught: Callable[[BaseException], None],
) -> None:
    """Shorten tracebacks of cells and of threads, unless `%xmode Verbose` is chosen.

    Args:
        shell: IPython.
        last_words: Returns how an exception has ended a foreground spin, '' if it has ended none.
            The stop button and the end of a program show that alone.
        uncaught: Called with what nobody has caught in a cell, in a thread or in a file of `%run`.
    """
    formatter = shell.InteractiveTB
    if 'structured_traceback' in vars(formatter):
        return
    original, show = formatter.structured_traceback, shell.showtraceback
    in_thread = threading.excepthook

    def structured_traceback(
        kind: Any, error: Any = None, tb: Any = None, *args: Any, **options: Any
    ) -> Any:
        words = [last_words(error)] if isinstance(error, BaseException) else []
        if any(words) and isinstance(error, (KeyboardInterrupt, SystemExit)):
            return words
        hint = [*_hint(error, tb), *filter(None, words)]
        if formatter.mode == 'Verbose' or not isinstance(tb, TracebackType):
            return [*original(kind, error, tb, *args, **options), *hint]
        with _causes_without_ros(error):
            return [*original(kind, error, without_ros(tb), *args, **options), *hint]

    def showtraceback(exc_tuple: Any = None, *args: Any, **options: Any) -> None:
        error = exc_tuple[1] if exc_tuple else sys.exc_info()[1]
        if isinstance(error, SystemExit) and last_words(error):
            # IPython says of each that it is no way to end the kernel.
            warnings.filterwarnings('ignore', "To exit: use 'exit'")
            options['exception_only'] = False
        if isinstance(error, LabError):  # it is shown without `structured_traceback`
            error.end = last_words(error)
        show(exc_tuple, *args, **options)
        if error is not None:
            uncaught(error)

    def excepthook(args: threading.ExceptHookArgs) -> None:
        error = args.exc_value
        if isinstance(error, (KeyboardInterrupt, SystemExit)) and (words := last_words(error)):
            print(words)  # Python does not tell that a thread ends in this way
            uncaught(error)
            return
        frames = [frame for frame, _ in traceback.walk_tb(args.exc_traceback)]
        if formatter.mode == 'Verbose' or not any(
            is_learners(frame.f_code.co_filename) for frame in frames
        ):
            in_thread(args)
        elif error is not None and not isinstance(error, SystemExit):
            name = args.thread.name if args.thread else 'a thread'
            print(f'An error has ended {name}:\n{short_traceback(error)}', file=sys.stderr)

    formatter.structured_traceback = structured_traceback
    shell.showtraceback = showtraceback
    threading.excepthook = excepthook


@contextmanager
def _causes_without_ros(error: BaseException | None) -> Iterator[None]:
    """Shorten the tracebacks of what has led to an error for a `with` block."""
    whole: dict[int, tuple[BaseException, TracebackType | None]] = {}
    left = [error]
    while left:
        one = left.pop()
        if one is not None and id(one) not in whole:
            whole[id(one)] = one, one.__traceback__
            one.__traceback__ = without_ros(one.__traceback__) or one.__traceback__
            left += [one.__cause__, one.__context__]
    try:
        yield
    finally:
        for one, tb in whole.values():
            one.__traceback__ = tb


def _hint(error: object, tb: object) -> list[str]:
    """Return a hint where Python's words don't say what to do."""
    if isinstance(error, RuntimeError) and str(error).startswith('asyncio.run() cannot be'):
        return [_IN_A_LOOP]
    known = (AttributeError, TypeError, InvalidHandle)
    if not isinstance(error, known) or not isinstance(tb, TracebackType):
        return []
    text, walked = str(error), list(traceback.walk_tb(tb))
    if isinstance(error, InvalidHandle):
        used = walked[-1][0]
        gone = None if is_learners(used.f_code.co_filename) else used.f_locals.get('self')
        return [_DESTROYED.format(kind=type(gone).__name__)] if gone is not None else []
    lacks: Any = getattr(error, 'obj', None)
    if isinstance(lacks, rclpy.node.Node) and not hasattr(lacks, 'context'):
        by_ros = not is_learners(walked[-1][0].f_code.co_filename)
        return [_NOT_YET.format(kind=type(lacks).__name__)] if by_ros else []
    lines = [linecache.getline(frame.f_code.co_filename, number) for frame, number in walked]
    # Python 3.10 raises an AttributeError (__enter__), later ones a TypeError.
    about_with = re.search('__enter__|context manager', text)
    if about_with and any(re.search(r'\bwith\b.*\binit\(', line) for line in lines):
        return [_WITH_INIT]
    # In this order: rclpy's own words, Python from 3.11 on, Python 3.10.
    taken = re.match(
        r"(\w+)(?= cannot be mod)|property '(\w+)' of|can't set attribute '(\w+)'", text
    )
    name = next(filter(None, taken.groups()), '') if taken else ''
    in_node = any(isinstance(one, rclpy.node.Node) for one in walked[-1][0].f_locals.values())
    if in_node and isinstance(getattr(rclpy.node.Node, name, None), property):
        return [_TAKEN.format(name=name)]
    made: Any = walked[-1][0].f_locals.get('self')
    read_only = re.search(r"attribute '(\w+)' is read-only", text)
    if read_only and hasattr(made, 'get_fields_and_field_types'):
        _undo_assignments(type(made))
        return [_ON_THE_CLASS.format(name=read_only[1], kind=type(made).__name__)]
    return []


def _undo_assignments(kind: Any) -> None:
    """Give a class of messages its properties back, from its module as it was written."""
    spec = importlib.util.find_spec(kind.__module__)
    if spec is None or spec.loader is None:
        return
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for name in kind.get_fields_and_field_types():
        setattr(kind, name, vars(vars(module)[kind.__name__])[name])


def _is_ros(filename: str) -> bool:
    path = os.path.abspath(filename)
    return path.startswith((_LABKIT, _RCLPY)) or (
        path.startswith(_LIBRARIES) and any(kind in path for kind in _INTERFACES)
    )
