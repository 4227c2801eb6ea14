"""Errors in the learner's code: which there was, where it hangs, what the mistake behind it is."""

from __future__ import annotations

import linecache
import re
from collections.abc import Callable
from types import FrameType
from typing import Any

from labkit import settings
from labkit.errors import LabError, cell_name
from labkit.exercises.mistakes import Mistake
from labkit.exercises.verdict import LearnerError

__all__ = ['LastCell', 'explain_error', 'last_cell', 'where_it_hangs']


class LastCell:
    """Remember the error of the cell that was run last.

    A cell whose code raises leaves nothing on the graph. Without this, a check would say of it
    that nothing was attempted.
    """

    def __init__(self) -> None:
        self.error: BaseException | None = None
        self._asked = False
        self._after: list[Callable[[], None]] = []
        self._shell: Any = None

    def follow(self) -> None:
        """Look at every cell from now on. Without effect outside IPython."""
        shell = settings.shell()
        if shell is not None and shell is not self._shell:
            self._shell = shell
            shell.events.register('post_run_cell', self._look)

    def asked(self) -> None:
        """Say that the running cell asks about the one before it, and does not count itself."""
        self._asked = True

    def after_each(self, action: Callable[[], None]) -> None:
        """Call `action` after each cell, once however often it is given."""
        if action not in self._after:
            self._after.append(action)

    def learner_error(self) -> LearnerError | None:
        """Return the error of the last cell, None if it ended well."""
        if self.error is None or isinstance(self.error, KeyboardInterrupt):
            return None
        from labkit.background.tracebacks import short_traceback

        return LearnerError('The cell that ran last', self.error, short_traceback(self.error))

    def _look(self, result: Any) -> None:
        if not self._asked:
            self.error = result.error_before_exec or result.error_in_exec
        self._asked = False
        for action in self._after:
            action()


last_cell = LastCell()


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
    text = str(error)
    if isinstance(error, SyntaxError):
        text = f'{text}\n{error.text or ""}'
    for types, pattern, mistake in _KNOWN:
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
        Mistake(
            'error/shell-command',
            'A cell holds Python. A line of a cell that is for the command line begins with %.',
            'Write %ros2 at the beginning of each line with a command.',
        ),
    ),
    (
        ('TypeError',),
        r'Node\.__init__\(\) missing 1 required positional argument: .node_name.',
        Mistake(
            'error/node-without-name',
            'A node needs a name.',
            "Give it one: super().__init__('my_node')",
        ),
    ),
    (
        ('TypeError',),
        r'Publisher\.publish\(\) missing',
        Mistake(
            'error/publish-nothing',
            'publish() sends a message, and got none.',
            'Pass it the message object: self.publisher.publish(msg)',
        ),
    ),
    (
        ('TypeError',),
        r'create_(?P<what>publisher|subscription)\(\) missing .*qos_profile',
        Mistake(
            'error/no-depth',
            'The last argument is missing: the depth of the queue.',
            'Add a number, such as 10, as the last argument.',
        ),
    ),
    (
        ('TypeError',),
        r'(?P<name>[\w.<>]+)\(\) missing \d+ required positional argument',
        Mistake(
            'error/called-at-once',
            '{name} was called without its argument. A callback is passed, not called: with '
            'brackets after its name Python calls it at once. And a timer calls its callback '
            'without any.',
            'Pass the name alone, without brackets.',
        ),
    ),
    (
        ('TypeError',),
        r'(?P<name>[\w.<>]+)\(\) takes 0 positional arguments but 1 was given',
        Mistake(
            'error/no-self',
            'A method gets the object itself as its first argument.',
            'Write self as the first parameter of {name}.',
        ),
    ),
    (
        ('LabError',),
        r'expects a function as its \w+, but got None: with brackets',
        Mistake(
            'error/callback-is-none',
            'A callback is None. With brackets after its name the function is called at once, '
            'and what it returns, None, is passed on as the callback.',
            'Pass the name alone, without brackets: self.on_timer, not self.on_timer().',
        ),
    ),
    (
        ('RuntimeError',),
        r'callback should be either be callable with one argument',
        Mistake(
            'error/callback-takes-no-message',
            'A subscription calls its callback with the message. This callback does not take '
            'one argument; or it was called, with brackets, and not passed.',
            'Define def on_message(self, msg): and pass self.on_message without brackets.',
        ),
    ),
    (
        ('TypeError',),
        r"Expected <class '.*\.(?P<want>\w+)'>, got <class '.*\.Metaclass_\w+'>",
        Mistake(
            'error/publishes-the-class',
            '{want} is the class; publish() takes an object made of it.',
            'Make one, with brackets: msg = {want}()',
        ),
    ),
    (
        ('TypeError',),
        r"Expected <class '.*\.(?P<want>\w+)'>, got <class '(?:.*\.)?(?P<got>\w+)'>",
        Mistake(
            'error/publishes-another-type',
            'publish() takes a message of the type that the publisher was made for, {want}; it '
            'got one of type {got}.',
            'Make a message of it first: msg = {want}(), then set its fields.',
        ),
    ),
    (
        ('AssertionError',),
        r"The '(?P<field>[\w.]+)' field must be an integer in (?P<range>\[.*\])",
        Mistake(
            'error/number-does-not-fit',
            'The field {field} holds whole numbers from one limit to the other, {range}. This '
            'number does not fit: unlike an int of Python, it has a fixed size.',
            'Keep the number within the limits, or use a larger type.',
        ),
    ),
    (
        ('AssertionError',),
        r"The '(?P<field>[\w.]+)' field must be of type '(?P<want>\w+)'",
        Mistake(
            'error/value-type',
            'The field {field} takes values of type {want} and no others: a message does not '
            'convert.',
            'Convert the value before you set the field: {want}(value)',
        ),
    ),
    (
        ('AssertionError',),
        r'Invalid arguments passed to constructor: (?P<name>.*)',
        Mistake(
            'error/no-such-field',
            'The message has no field called {name}.',
            '%ros2 interface show lists the fields of a message type.',
        ),
    ),
    (
        ('RCLError',),
        r'invalid allocator|incompatible type|existing topic name',
        Mistake(
            'error/topic-type',
            'This topic already has another type in this notebook. A topic carries one type. '
            'Within one process ROS refuses a second one, as here; between processes it says '
            'nothing.',
            'Use the type of the topic (%ros2 topic list -t), or another topic name.',
        ),
    ),
    (
        ('InvalidNodeNameException',),
        r'.',
        Mistake(
            'error/node-name',
            'The name of a node has letters, digits and _ only: no spaces, no slash.',
            "Write it like this: 'my_node'",
        ),
    ),
    (
        ('InvalidTopicNameException',),
        r'.',
        Mistake(
            'error/topic-name',
            'The name of a topic has letters, digits, _ and / only, no slash at the end, and '
            'no part of it starts with a digit.',
            "Write it like this: '/my_topic'",
        ),
    ),
    (
        ('TypeError',),
        r"float\(\) argument must be .* number, not 'tuple'",
        Mistake(
            'error/decimal-comma',
            'In Python a comma stands between two values: 0,25 is the pair of 0 and 25.',
            'Write the number with a point: 0.25',
        ),
    ),
    (
        ('LabError',),
        r'The callback of a service returns the response',
        Mistake(
            'error/no-response',
            'A callback of a service has to give its response back. Without "return" a '
            'function gives back None.',
            'End the callback with: return response',
        ),
    ),
    (
        ('LabError',),
        r'call_async\(\) (expects|sends) an object',
        Mistake(
            'error/request-type',
            'A client sends an object of the type of its requests, and got something else.',
            'Make one first, such as SetBool.Request(data=True), and pass it.',
        ),
    ),
    (
        ('AttributeError',),
        r"'(?P<kind>\w+)' object attribute '(?P<name>\w+)' is read-only",
        Mistake(
            'error/class-for-object',
            'An earlier cell has set {name} on the class {kind} itself, as after msg = {kind} '
            'without brackets.',
            'Write msg = {kind}(), with brackets.',
        ),
    ),
    (
        ('AttributeError',),
        r"'NoneType' object has no attribute '(?P<name>\w+)'",
        Mistake(
            'error/attribute-of-none',
            'What stands before .{name} is None. It was not set, or it is the result of a '
            'future that was not done yet.',
            'Set it before it is used. The result of a future is there in the callback that '
            'its add_done_callback() gets.',
        ),
    ),
    (
        ('AttributeError',),
        r"object has no attribute '_(Node__\w+|default_callback_group|logger|clock|rate_group|"
        r"parameter_overrides)'",
        Mistake(
            'error/no-super-init',
            'The node was not set up before it was used: super().__init__(...) has not been '
            'called.',
            "Make super().__init__('my_node') the first line of __init__.",
        ),
    ),
    (
        ('AttributeError',),
        r"^(?P<name>handle) cannot be modified|^property '(?P<other>\w+)' of '\w+' object has no "
        r"setter|^can't set attribute '(?P<third>\w+)'",
        Mistake(
            'error/taken-name',
            'rclpy uses the name {name}{other}{third} in each node for a thing of its own.',
            'Choose another name, such as self.my_{name}{other}{third}.',
        ),
    ),
    (
        ('AttributeError',),
        r"'(?P<kind>[A-Z]\w*)' object has no attribute '(?P<name>\w+)'",
        Mistake(
            'error/no-such-attribute',
            '{kind} has nothing called {name}: the name is misspelt, or it is made in a line '
            'that has not run yet.',
            'Compare the spelling, letter by letter, with the place where it is made.',
        ),
    ),
    (
        ('TypeError',),
        r"operand type\(s\) for .*: '(?P<kind>(?!None)[A-Z]\w*)'|"
        r'\(not \"(?P<other>(?!None)[A-Z]\w*)\"\)',
        Mistake(
            'error/message-for-value',
            'A message object ({kind}{other}) is not the value in it.',
            'Take the value out of the message: msg.data',
        ),
    ),
    (
        ('NameError',),
        r"name '(?P<name>\w+)' is not defined",
        Mistake(
            'error/name-not-defined',
            'Python does not know the name {name} here: it is misspelt, not imported, or lacks '
            'self.',
            'Import it, correct it, or write self.{name} if it belongs to the node.',
        ),
    ),
)
