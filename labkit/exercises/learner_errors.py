"""Errors in the learner's code: which there was, where it hangs, what the mistake behind it is."""

from __future__ import annotations

import linecache
import re
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from types import FrameType
from typing import Any

from labkit import settings
from labkit.errors import LabError, cell_name
from labkit.exercises.first_slips import SLIPS, unquoted
from labkit.exercises.machine_faults import machine_fault
from labkit.exercises.mistakes import Mistake
from labkit.exercises.verdict import LearnerError
from labkit.exercises.words import words_of

__all__ = ['LastCell', 'Run', 'explain_error', 'last_cell', 'where_it_hangs']


@dataclass(frozen=True)
class Run:
    """How a cell ended when it ran last.

    Attributes:
        cell_id: Its id in the notebook, `''` where the front end does not send it.
        number: Which execution of the notebook it was, as in `In[12]`.
        error: What it raised, None if it ended well or was stopped.
        stopped_in: The line of the learner's in which `__init__` of a node was stopped, `''` if
            none was.
    """

    cell_id: str
    number: int
    error: BaseException | None
    stopped_in: str = ''


WORDS = words_of(__file__)


class LastCell:
    """Remember the error of the cell that was run last, and of each cell when it ran last.

    A cell whose code raises leaves nothing on the graph. Without this, a check would say of it
    that nothing was attempted.
    """

    def __init__(self) -> None:
        self.run: Run | None = None
        # Whether a cell is running.
        self.is_running = False
        self._runs: dict[str, Run] = {}
        self._checks: dict[str, int] = {}
        self._asked = False
        self._after: list[Callable[[], None]] = []
        self._shell: Any = None

    def follow(self) -> None:
        """Look at every cell from now on. Without effect outside IPython."""
        shell = settings.shell()
        if shell is not None and shell is not self._shell:
            self._shell = shell
            self.is_running = True  # it is a cell that follows
            shell.events.register('pre_run_cell', self._begin)
            shell.events.register('post_run_cell', self._look)

    def asked(self, checks: str = '') -> None:
        """Say that the running cell asks about the one before it, and does not count itself.

        Args:
            checks: Name of the exercise that it checks, if it does.
        """
        self._asked = True
        if checks:
            self.checked(checks)

    def checked(self, name: str) -> None:
        """Note that an exercise is checked, by the running cell or by a button after the last."""
        if self._shell is not None:
            from labkit.background.compat import running_number

            self._checks[name] = running_number()

    def since_another_check(self, name: str) -> int:
        """Return from which execution on cells are about an exercise, and no other.

        Those behind the last check of another one are; before there was one, the last cell is.
        """
        others = [number for other, number in self._checks.items() if other != name]
        last = self.run.number if self.run is not None else 0
        return max(others, default=last - 1) + 1

    def after_each(self, action: Callable[[], None]) -> None:
        """Call `action` after each cell, once however often it is given."""
        if action not in self._after:
            self._after.append(action)

    def run_of(self, cell_id: str) -> Run | None:
        """Return how a cell ended when it ran last, None if it has not run."""
        return self._runs.get(cell_id)

    def learner_error(self, run: Run | None = None) -> LearnerError | None:
        """Return the error of a run, by default of the last one; None if it ended well."""
        run = run or self.run
        if run is None or run.error is None:
            return None
        from labkit.background.tracebacks import short_traceback

        where = 'The cell that ran last' if run is self.run else 'The cell of this exercise'
        return LearnerError(where, run.error, short_traceback(run.error))

    def _begin(self, _: Any) -> None:
        self.is_running, self._asked = True, False

    def _look(self, result: Any) -> None:
        self.is_running = False
        if not self._asked:
            error = result.error_before_exec or result.error_in_exec
            stopped_in = ''
            if isinstance(error, KeyboardInterrupt):
                stopped_in, error = _stopped_in(error), None
            cell_id = getattr(result.info, 'cell_id', None) or ''
            self.run = Run(cell_id, result.execution_count or 0, error, stopped_in)
            self._runs[cell_id] = self.run
        self._asked = False
        for action in self._after:
            action()


last_cell = LastCell()


def _stopped_in(error: KeyboardInterrupt) -> str:
    """Return the line in which `__init__` of a class was stopped, `''` if none was."""
    lines = [
        (frame.f_code, number)
        for frame, number in traceback.walk_tb(error.__traceback__)
        if cell_name(frame.f_code.co_filename)
    ]
    if not any(code.co_name == '__init__' for code, _ in lines):
        return ''
    name, number = lines[-1][0].co_filename, lines[-1][1]
    source = linecache.getline(name, number).strip()
    return f'{cell_name(name)}, line {number}: {source}'


def where_it_hangs(frame: FrameType | None) -> str:
    """Return the learner's line that a thread is in: `'Cell In[3], line 5: time.sleep(1)'`."""
    while frame is not None:
        name = frame.f_code.co_filename
        cell = cell_name(name)
        if cell:
            source = linecache.getline(name, frame.f_lineno).strip()
            return f'{cell}, line {frame.f_lineno}: {source}'
        frame = frame.f_back
    return ''


def explain_error(error: BaseException) -> Mistake | None:
    """Return what a beginner most likely got wrong; None where it is not known.

    Args:
        error: What the learner's code raised.
    """
    fault = machine_fault(error)
    if fault is not None:
        return fault
    text = str(error)
    if isinstance(error, SyntaxError):
        text = f'{text}\n{error.text or ""}'
    slip = unquoted(error)
    if slip is not None:
        return slip
    for types, pattern, mistake in (*_KNOWN, *SLIPS):
        match = re.search(pattern, text) if type(error).__name__ in types else None
        if match:
            return mistake.of(**{key: value or '' for key, value in match.groupdict().items()})
    return Mistake('').then(error.todo) if isinstance(error, LabError) else None


# Names of the exception, what its text looks like, the misconception. The first that fits is
# taken. The texts are those of Python 3.10 to 3.13, rclpy 7.1 and its messages.
_KNOWN: tuple[tuple[tuple[str, ...], str, Mistake], ...] = (
    (
        ('SyntaxError', 'IndentationError'),
        r'(?m)^\s*[$>]?\s*ros2\b',
        WORDS.mistake('error/shell-command'),
    ),
    (
        ('TypeError',),
        r'Node\.__init__\(\) missing 1 required positional argument: .node_name.',
        WORDS.mistake('error/node-without-name'),
    ),
    (
        ('TypeError',),
        r'Publisher\.publish\(\) missing',
        WORDS.mistake('error/publish-nothing'),
    ),
    (
        ('TypeError',),
        r'create_(?P<what>publisher|subscription)\(\) missing .*qos_profile',
        WORDS.mistake('error/no-depth'),
    ),
    (
        ('TypeError',),
        r'(?P<name>[\w.<>]+)\(\) missing \d+ required positional argument',
        WORDS.mistake('error/called-at-once'),
    ),
    (
        ('TypeError',),
        r'(?P<name>[\w.<>]+)\(\) takes 0 positional arguments but 1 was given',
        WORDS.mistake('error/no-self'),
    ),
    (
        ('LabError',),
        r'expects a function as its \w+, but got None: with brackets',
        WORDS.mistake('error/callback-is-none'),
    ),
    (
        ('RuntimeError',),
        r'callback should be either be callable with one argument',
        WORDS.mistake('error/callback-takes-no-message'),
    ),
    (
        ('TypeError',),
        r"Expected <class '.*\.(?P<want>\w+)'>, got <class '.*\.Metaclass_\w+'>",
        WORDS.mistake('error/publishes-the-class'),
    ),
    (
        ('TypeError',),
        r"Expected <class '.*\.(?P<want>\w+)'>, got <class '(?:.*\.)?(?P<got>\w+)'>",
        WORDS.mistake('error/publishes-another-type'),
    ),
    (
        ('AssertionError',),
        r"The '(?P<field>[\w.]+)' field must be an integer in (?P<range>\[.*\])",
        WORDS.mistake('error/number-does-not-fit'),
    ),
    (
        ('AssertionError',),
        r"The '(?P<field>[\w.]+)' field must be of type '(?P<want>\w+)'",
        WORDS.mistake('error/value-type'),
    ),
    (
        ('AssertionError',),
        r'Invalid arguments passed to constructor: (?P<name>.*)',
        WORDS.mistake('error/no-such-field'),
    ),
    (
        ('RCLError',),
        r'invalid allocator|incompatible type|existing topic name',
        WORDS.mistake('error/topic-type'),
    ),
    (
        ('InvalidNodeNameException',),
        r'.',
        WORDS.mistake('error/node-name'),
    ),
    (
        ('InvalidTopicNameException',),
        r'.',
        WORDS.mistake('error/topic-name'),
    ),
    (
        ('TypeError',),
        r"float\(\) argument must be .* number, not 'tuple'",
        WORDS.mistake('error/decimal-comma'),
    ),
    (
        ('LabError',),
        r'The callback of a service returns the response',
        WORDS.mistake('error/no-response'),
    ),
    (
        ('LabError',),
        r'call_async\(\) (expects|sends) an object',
        WORDS.mistake('error/request-type'),
    ),
    (
        ('AttributeError',),
        r"'(?P<kind>\w+)' object attribute '(?P<name>\w+)' is read-only",
        WORDS.mistake('error/class-for-object'),
    ),
    (
        ('AttributeError',),
        r"'NoneType' object has no attribute '(?P<name>\w+)'",
        WORDS.mistake('error/attribute-of-none'),
    ),
    (
        ('AttributeError',),
        r"object has no attribute '_(Node__\w+|default_callback_group|logger|clock|rate_group|"
        r"parameter_overrides)'",
        WORDS.mistake('error/no-super-init'),
    ),
    (
        ('AttributeError',),
        r"^(?P<name>handle) cannot be modified|^property '(?P<other>\w+)' of '\w+' object has no "
        r"setter|^can't set attribute '(?P<third>\w+)'",
        WORDS.mistake('error/taken-name'),
    ),
    (
        ('AttributeError',),
        r"'(?P<kind>[A-Z]\w*)' object has no attribute '(?P<name>\w+)'",
        WORDS.mistake('error/no-such-attribute'),
    ),
    (
        ('TypeError',),
        r"operand type\(s\) for .*: '(?P<kind>(?!None)[A-Z]\w*)'|"
        r'\(not \"(?P<other>(?!None)[A-Z]\w*)\"\)',
        WORDS.mistake('error/message-for-value'),
    ),
    (
        ('NameError',),
        r"name '(?P<name>\w+)' is not defined",
        WORDS.mistake('error/name-not-defined'),
    ),
)
