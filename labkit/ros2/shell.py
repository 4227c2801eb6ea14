"""Take a line of words, find the command and verb that it names, run it, print complaints."""

from __future__ import annotations

import importlib
import shlex
import sys
from argparse import Namespace
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from labkit import settings
from labkit.errors import LabError, nearest
from labkit.ros2.parser import Command, Done, Usage, Verb, table
from labkit.rosgraph.refusals import Refusal, Refused

__all__ = ['COMMANDS', 'Ran', 'command', 'execute', 'history', 'run_line', 'split']

# Command -> the module that has it as `COMMAND`.
COMMANDS = {
    'action': 'labkit.ros2.action',
    'bag': 'labkit.ros2.bag',
    'doctor': 'labkit.ros2.doctor',
    'interface': 'labkit.ros2.interface',
    'node': 'labkit.ros2.node',
    'param': 'labkit.ros2.param',
    'pkg': 'labkit.ros2.pkg',
    'run': 'labkit.ros2.run',
    'service': 'labkit.ros2.service',
    'topic': 'labkit.ros2.topic',
}
# What a full installation has too. Named, so that nobody takes them for a slip of the pen.
_ELSEWHERE = (
    *('component', 'control', 'daemon', 'launch', 'lifecycle', 'multicast', 'plugin'),
    *('security', 'test', 'wtf'),
)
# At the end of a line it sends the command to the background, in a notebook too.
BACKGROUND = '&'
_SHELL_SIGNS = {'|', '||', '&', '&&', ';', '>', '>>', '<', '<<'}


@dataclass(frozen=True)
class Ran:
    """A command that was run.

    A judge takes the last one of `history` that has to do with its exercise. If `reason` is one
    that it has an explanation for, it explains that; if `topic` is not its own, the command went
    elsewhere; otherwise it shows `complaint`. It need not read the words, nor the complaint.

        tried = [ran for ran in history if ran.words[:2] == ('topic', 'pub')]
        if tried and tried[-1].reason is Refusal.SPACE_AFTER_COLON: ...

    Attributes:
        words: The words after `ros2`.
        complaint: What was said to be wrong with it, '' if nothing was.
        reason: Why it was refused, None if it was not.
        topic: Full name of the topic that it named, '' if it named none. Of a command that was
            refused as far as can be told, so it may be no name that a topic can have.
    """

    words: tuple[str, ...]
    complaint: str
    reason: Refusal | None = None
    topic: str = ''


history: deque[Ran] = deque(maxlen=100)
"""The commands that this process has run, oldest first."""


def run_line(line: str) -> int:
    """Run what stands after `%ros2` in a cell; print what goes wrong.

    Args:
        line: The words, quoted as in a terminal.

    Returns:
        The exit code of the real `ros2`: 0 if all went well.
    """
    try:
        words = split(line)
    except Usage as error:
        return _complain(line.split(), 2, error)
    if _ends_in_background(line, words):
        return execute(words[:-1], background=True)
    return execute(words)


def split(line: str) -> list[str]:
    """Split a line into words as a terminal does; a comment is left out.

    Raises:
        Usage: A quotation mark is missing, or it asks for what only a terminal can do.
    """
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    lexer.commenters = ''
    words = []
    try:
        for word in lexer:
            if word.startswith('#') and not _is_quoted(line, word):
                break
            words += [word]
    except ValueError as error:
        raise Usage(
            f'The line can not be read: {error}.',
            todo='A quotation mark " or \' is missing.',
            reason=Refusal.QUOTE_NOT_CLOSED,
        ) from error
    sent = words[:-1] if _ends_in_background(line, words) else words
    sign = next((word for word in sent if word in _SHELL_SIGNS), '')
    if sign and not _is_quoted(line, sign):
        raise Usage(
            f'{sign!r} belongs to a terminal; %ros2 runs one command.',
            todo='Leave it out, put it in quotation marks, or use a terminal: !ros2 ...',
            reason=Refusal.TERMINAL_SIGN,
        )
    return words


def execute(words: Sequence[str], *, background: bool = False) -> int:
    """Run a command; print what goes wrong. Only a BrokenPipeError leaves this function.

    Args:
        words: The words after `ros2`.
        background: Whether to start it as a process of its own, and not wait for its end.

    Returns:
        The exit code: 0 if all went well, 2 if the words can't be understood or it was
        interrupted, else 1.
    """
    try:
        result = _start(list(words)) if background else _run(list(words))
    except Done:
        result = 0
    except KeyboardInterrupt:
        result = 2  # SIGINT, as the real one
    except Usage as error:
        return _complain(words, 2, error)
    except LabError as error:
        return _complain(words, 1, error)
    except BrokenPipeError:
        raise
    except Exception as error:  # never a traceback: nobody who types a command can read it
        return _complain(words, 1, LabError(f'{type(error).__name__}: {error}'))
    if isinstance(result, str):
        return _complain(words, 1, LabError(result))
    history.append(Ran(tuple(words), '', topic=_topic_in(words)))
    return int(result or 0)


def _complain(words: Sequence[str], code: int, error: LabError) -> int:
    reason = error.reason if isinstance(error, Refused) else Refusal.OTHER
    history.append(Ran(tuple(words), str(error), reason, _topic_in(words)))
    print(error, file=sys.stderr)
    return code


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
        Usage: There is none of that name.
    """
    if name in COMMANDS:
        found: Command = importlib.import_module(COMMANDS[name]).COMMAND
        return found
    if name in _ELSEWHERE:
        raise Usage(
            f'ros2 {name} is part of a full installation of ROS 2, but not of this course.',
            todo=f'Here: {", ".join(sorted(COMMANDS))}.',
            reason=Refusal.UNKNOWN_COMMAND,
        )
    near = nearest(name, COMMANDS)
    hint = f' Did you mean {near!r}?' if near else ''
    raise Usage(
        f'ros2 has no command {name!r}.{hint}',
        todo=f'usage: ros2 <command>   with one of: {", ".join(sorted(COMMANDS))}',
        reason=Refusal.UNKNOWN_COMMAND,
    )


def _run(words: list[str]) -> str | int | None:
    verb, args = _understand(words)
    return verb.run(args)


def _start(words: list[str]) -> str | int | None:
    """Start a command in the background; a bad one is refused here and now."""
    verb, args = _understand(words)
    if verb.name == 'run':
        return verb.run(args)  # is in the background anyway
    from labkit.ros2.background_command import start

    return start(words, args)


def _understand(words: list[str]) -> tuple[Verb, Namespace]:
    """Return the verb that the words name, and its arguments; show help if that is asked for."""
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
    """Split `--include-hidden-topics list -t` before the verb."""
    known = {'-h', '--help', *chosen.options}
    count = 0
    while count < len(words) and words[count].startswith('-'):
        if words[count] not in known:
            near = nearest(words[count], known)
            hint = f' Did you mean {near!r}?' if near else ''
            raise Usage(
                f'ros2 {chosen.name} has no option {words[count]!r}.{hint}',
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
    """Tell whether the line ends with the sign that a shell sends a command away with."""
    sent = words[-1:] == [BACKGROUND] and not _is_quoted(line, BACKGROUND)
    return sent and settings.in_kernel()


def _is_quoted(line: str, word: str) -> bool:
    return f'"{word}' in line or f"'{word}" in line
