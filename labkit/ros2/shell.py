"""Run a `ros2` line: find command and verb, run them, print errors."""

from __future__ import annotations

import importlib
import io
import re
import shlex
import sys
from argparse import Namespace
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from labkit import settings
from labkit.errors import LabError, nearest, quoted
from labkit.ros2.parser import Command, Done, RealOne, Usage, Verb, table
from labkit.rosgraph.refusals import Refusal, Refused

__all__ = ['COMMANDS', 'Ran', 'command', 'execute', 'history', 'is_complete', 'run_line', 'split']

# Command -> the module that has it as `COMMAND`.
COMMANDS = {
    'action': 'labkit.ros2.action',
    'bag': 'labkit.ros2.bag',
    'doctor': 'labkit.ros2.doctor',
    'interface': 'labkit.ros2.interface',
    'launch': 'labkit.ros2.launch',
    'lifecycle': 'labkit.ros2.lifecycle',
    'node': 'labkit.ros2.node',
    'param': 'labkit.ros2.param',
    'pkg': 'labkit.ros2.pkg',
    'run': 'labkit.ros2.run',
    'service': 'labkit.ros2.service',
    'topic': 'labkit.ros2.topic',
}
# Commands of a full installation -> what they do, and what does it here.
_ELSEWHERE = {
    'component': (
        'loads nodes in C++ into a running process',
        'Nodes in Python can not be loaded so. Nodes of a notebook share its process anyway.',
    ),
    'control': ('manages the controllers of ros2_control, which are in C++', ''),
    'daemon': (
        'starts and stops a process in the background that knows the graph',
        'A command asks the running notebook, which knows it; without one it looks for itself.',
    ),
    'multicast': (
        'sends and receives a packet, to try a network out',
        'ros2 doctor tells how nodes look for each other here.',
    ),
    'plugin': ('lists plugins in C++', ''),
    'security': ('makes keys and rules for encrypted traffic', ''),
    'test': ('runs tests of launch files', 'pytest runs the tests of a package.'),
    'wtf': ('is another name of doctor', 'Write ros2 doctor.'),
}
# At the end of a line it sends the command to the background, in a notebook too.
BACKGROUND = '&'
# What pages and word processors make of quotation marks and hyphens, where a word has its own, and
# of spaces.
_TYPOGRAPHIC = re.compile(
    r"""[“”„‟«»‘’‚‛](?=[\s\]}),:]|$) | (?:(?<=[\s\[{(,:=]) | ^) [“”„‟«»‘’‚‛]
    | (?:(?<=\s) | ^) [‐‑‒–—−] | [\u00a0\u2007\u202f\u200b\ufeff]""",
    re.VERBOSE,
)
_SHELL_SIGNS = {'|', '||', '&', '&&', ';', '>', '>>', '<', '<<'}


@dataclass(frozen=True)
class Ran:
    """A finished command, for checks of exercises.

    A check looks at the last relevant command of `history`. If it can explain `reason`, it does;
    if `topic` is not the right one, the command went elsewhere; otherwise it shows `complaint`.

    Attributes:
        words: The words after `ros2`.
        complaint: The error message, '' if there was none.
        reason: Why it was refused, None if it was not.
        topic: Full name of the topic it named, '' if none. For a refused command it is a guess,
            and may be an invalid name.
    """

    words: tuple[str, ...]
    complaint: str
    reason: Refusal | None = None
    topic: str = ''


history: deque[Ran] = deque(maxlen=100)
"""The commands that this process has run, oldest first."""


def run_line(line: str) -> int:
    """Run the text after `%ros2` in a cell; print errors.

    Args:
        line: The words, quoted as in a terminal.

    Returns:
        The exit code of the real `ros2`: 0 on success.
    """
    try:
        words = split(line)
    except Usage as error:
        return _complain(line.split(), 2, error)
    if _ends_in_background(line, words):
        return execute(words[:-1], background=True)
    return execute(words)


def is_complete(text: str) -> bool:
    """Return whether a terminal would run this, and not ask for another line."""
    try:
        split(text)
    except Usage as error:
        return error.reason is not Refusal.QUOTE_NOT_CLOSED
    return not text.endswith('\\\n')


def split(line: str) -> list[str]:
    """Split a line into words as a terminal does; drop comments.

    In quotation marks it may go on over several lines, and after a backslash at a line's end.

    Raises:
        Usage: A quotation mark is missing, or the line needs a terminal.
    """
    line = line.replace('\\\n', '')
    text = io.StringIO(line)
    lexer = shlex.shlex(text, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    lexer.commenters = ''
    words = []
    try:
        for word in lexer:
            if word.startswith('#') and not _is_quoted(line, word):
                at = text.tell() - 1  # of what has ended the word
                if '\n' not in line[at:]:
                    break
                if line[at] != '\n':
                    text.readline()
                continue
            words += [word]
    except ValueError as error:
        raise Usage(
            f'The line can not be read: {error}.',
            todo='A quotation mark " or \' is missing'
            + (': all of the lines after it were taken for its text.' if '\n' in line else '.'),
            reason=Refusal.QUOTE_NOT_CLOSED,
        ) from error
    sent = words[:-1] if _ends_in_background(line, words) else words
    sign = next((word for word in sent if word in _SHELL_SIGNS), '')
    if sign and not _is_quoted(line, sign):
        raise Usage(
            f'{quoted(sign)} belongs to a terminal; %ros2 runs one command.',
            todo='Leave it out, put it in quotation marks, or use a terminal: !ros2 ...',
            reason=Refusal.TERMINAL_SIGN,
        )
    return words


def execute(words: Sequence[str], *, background: bool = False) -> int:
    """Run a command; print errors. Only a BrokenPipeError leaves this function.

    Args:
        words: The words after `ros2`.
        background: Whether to start it in its own process, without waiting for its end.

    Returns:
        The exit code: 0 on success, 2 if the words can't be parsed or it was interrupted, else 1.
    """
    try:
        result = _start(list(words)) if background else _run(list(words))
    except Done:
        result = 0
    except KeyboardInterrupt:
        result = 2  # SIGINT, as with the real command
    except LabError as error:
        told = getattr(error, 'real_one', None)
        if told is None or settings.audience().wants_reasons:
            return _complain(words, 2 if isinstance(error, Usage) else 1, error)
        return _end_as(told)
    except BrokenPipeError:
        raise
    except Exception as error:  # never a traceback: the user of a command can't read it
        return _complain(words, 1, LabError(f'{type(error).__name__}: {error}'))
    if isinstance(result, str):
        return _complain(words, 1, LabError(result))
    history.append(Ran(tuple(words), '', topic=_topic_in(words)))
    return int(result or 0)


def _complain(words: Sequence[str], code: int, error: LabError) -> int:
    reason = error.reason if isinstance(error, Refused) else Refusal.OTHER
    complaint = '\n'.join(filter(None, [str(error), _typographic(' '.join(words))]))
    history.append(Ran(tuple(words), complaint, reason, _topic_in(words)))
    print(complaint, file=sys.stderr)
    return code


def _typographic(line: str) -> str:
    """Return a hint if a line has signs that look like those which a command understands."""
    signs = dict.fromkeys(_TYPOGRAPHIC.findall(line))
    told = [
        sign if sign.isprintable() else f'U+{ord(sign):04X} (no plain space)' for sign in signs
    ]
    return (
        f'In this line is {" and ".join(told)}, as pages and word processors write it; to a '
        'command it is a letter. Type plain signs instead: " or \', - or --, a space.'
        if told
        else ''
    )


def _end_as(told: RealOne) -> int:
    if told.shows:
        print(told.shows)
    if told.says:
        print(told.says, file=sys.stderr)
    return told.code


def _topic_in(words: Sequence[str]) -> str:
    """Return the topic that a command names, '' if it names none."""
    try:
        chosen = command(words[0])
        _, rest = _options_before_verb(chosen, list(words[1:]))
        verb = chosen.verb(rest[0])
    except (LabError, IndexError):
        return ''
    known, _ = verb.parser(chosen.name).guess(rest[1:])
    name = str(getattr(known, 'topic_name', ''))
    return name if name.startswith('/') or not name else f'/{name}'


def command(name: str) -> Command:
    """Return a command by its name.

    Raises:
        Usage: There is no such command.
    """
    if name in COMMANDS:
        found: Command = importlib.import_module(COMMANDS[name]).COMMAND
        return found
    if name in _ELSEWHERE:
        does, instead = _ELSEWHERE[name]
        raise Usage(
            f'ros2 {name} is part of a full installation of ROS 2, but not of this course. It '
            f'{does}.',
            todo=' '.join(filter(None, [instead, f'Here: {", ".join(sorted(COMMANDS))}.'])),
            reason=Refusal.UNKNOWN_COMMAND,
        )
    near = nearest(name, COMMANDS)
    hint = f' Did you mean {near!r}?' if near else ''
    raise Usage(
        f'ros2 has no command {quoted(name)}.{hint}',
        todo=f'usage: ros2 <command>   with one of: {", ".join(sorted(COMMANDS))}',
        reason=Refusal.UNKNOWN_COMMAND,
    )


def _run(words: list[str]) -> str | int | None:
    verb, args = _understand(words)
    return verb.run(args)


def _start(words: list[str]) -> str | int | None:
    """Start a command in the background; raise errors in it right away."""
    verb, args = _understand(words)
    if verb.name in ('launch', 'run'):
        return verb.run(args)  # already runs in the background
    from labkit.ros2.background_command import start

    return start(words, args)


def _understand(words: list[str]) -> tuple[Verb, Namespace]:
    """Return the verb and its arguments; show help if requested."""
    for word in words:
        if any('\ud800' <= char <= '\udfff' for char in word):  # a byte that is none in UTF-8
            raise Usage(f'{quoted(word)} is no text in UTF-8.')
    if not words or words[0] in ('-h', '--help'):
        print(_help())
        raise Done
    chosen = command(words[0])
    if not chosen.has_verbs:
        verb, rest = chosen.verbs[0], words[1:]
    else:
        before, rest = _options_before_verb(chosen, words[1:])
        if not rest or '-h' in before or '--help' in before:
            print(chosen.help())
            raise Done
        verb, rest = chosen.verb(rest[0]), [*before, *rest[1:]]
    return verb, verb.parser(chosen.name).read(rest)


def _options_before_verb(chosen: Command, words: list[str]) -> tuple[list[str], list[str]]:
    """Split off the options before the verb, as in `--include-hidden-topics list -t`."""
    known = {'-h', '--help', *chosen.options}
    count = 0
    while count < len(words) and words[count].startswith('-'):
        if words[count] not in known:
            near = nearest(words[count], known)
            hint = f' Did you mean {near!r}?' if near else ''
            raise Usage(
                f'ros2 {chosen.name} has no option {quoted(words[count])}.{hint}',
                reason=Refusal.UNKNOWN_OPTION,
            )
        count += 1
    return words[:count], words[count:]


def _help() -> str:
    rows = [(name, command(name).summary) for name in COMMANDS]
    return '\n'.join(
        [
            'usage: ros2 [-h] <command> ...',
            '',
            'ros2 is an extensible command-line tool for ROS 2.',
            '',
            'options:',
            '  -h, --help  show this help message and exit',
            '',
            'Commands:',
            *table(rows),
            '',
            '  Call `ros2 <command> -h` for more detailed usage.',
        ]
    )


def _ends_in_background(line: str, words: list[str]) -> bool:
    """Return whether the line ends with the shell's sign for the background."""
    sent = words[-1:] == [BACKGROUND] and not _is_quoted(line, BACKGROUND)
    return sent and settings.in_kernel()


def _is_quoted(line: str, word: str) -> bool:
    return f'"{word}' in line or f"'{word}" in line
