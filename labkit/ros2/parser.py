"""Commands, verbs and options: parsing a `ros2` line, and errors in it.

Words and options are those of the real `ros2`. Errors are our own: one sentence with the nearest
right word, then the usage line. They are the same in every version of Python, so that they can be
stored in a notebook.
"""

from __future__ import annotations

import argparse
import math
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, NoReturn

from labkit.errors import LabError, nearest, quoted
from labkit.rosgraph.refusals import Refusal, Refused

__all__ = [
    'Command',
    'Done',
    'Parser',
    'RealOne',
    'Usage',
    'Verb',
    'positive_float',
    'positive_int',
    'real_one',
    'unsigned_int',
]

# Width of the help text.
WIDTH = 88

Complete = Callable[[argparse.Namespace], Iterable[str]]
"""Return the completion candidates for a word, given the words before it."""


class Usage(Refused):
    """Report a line that can't be parsed. Exit code 2, as with the real `ros2`."""


class Done(Exception):
    """End a line early, because help was requested and shown."""


@dataclass(frozen=True)
class RealOne:
    """How the real `ros2` ends where this one explains.

    Attributes:
        says: What it prints on standard error, '' if nothing.
        shows: What it prints on standard output, '' if nothing.
        code: Its exit code.
    """

    says: str
    shows: str
    code: int


@contextmanager
def real_one(says: str | None = None, *, shows: str = '', code: int = 1) -> Iterator[None]:
    """Let errors of a `with` block end the line as the real `ros2` does, if a script runs it.

    Args:
        says: As in `RealOne`; the error without what to do next if None.
        shows: As in `RealOne`.
        code: As in `RealOne`.
    """
    try:
        yield
    except LabError as error:
        told = error.message if says is None else says
        error.real_one = RealOne(told, shows, code)  # type: ignore[attr-defined]
        raise


class Parser(argparse.ArgumentParser):
    """An argument parser that raises `Usage` and never ends the process.

    Args:
        prog: The command and verb, such as `ros2 topic echo`.
        description: Its purpose, in one line.
    """

    def __init__(self, prog: str, description: str = '') -> None:
        super().__init__(
            prog=prog,
            description=description,
            formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, width=WIDTH),
        )

    def add(
        self, *names: str, complete: Complete | None = None, **options: Any
    ) -> argparse.Action:
        """Add an argument with its completion.

        Args:
            names: Name or option strings, as for `add_argument`.
            complete: Returns completion candidates.
            options: As for `add_argument`.
        """
        if 'choices' in options:
            # The wording of argparse's own error depends on the version of Python.
            choices = list(options.pop('choices'))
            options['type'] = _choice(choices)
            options.setdefault('metavar', '{' + ','.join(choices) + '}')
            complete = complete or (lambda _: choices)
        action = self.add_argument(*names, **options)
        action.complete = complete  # type: ignore[attr-defined]
        return action

    def flag(self, names: str, help: str, **options: Any) -> None:
        """Add an option without a value: `flag('-v, --verbose', 'Say more')`."""
        self.add(*names.split(', '), action='store_true', help=help, **options)

    def accept(self, *names: str, flag: bool = False) -> None:
        """Add an option of the real verb that has no effect here."""
        form: dict[str, Any] = {'action': 'store_true'} if flag else {'metavar': 'X'}
        self.add(*names, help='accepted, without effect', **form)

    def refuse(self, *names: str, why: str) -> None:
        """Add an option of the real verb that is refused in words."""
        self.add(*names, action=_Refusing, nargs='*', metavar='X', help=f'refused here: {why}')

    @property
    def actions(self) -> list[argparse.Action]:
        """All arguments, in the order they were added."""
        return self._actions

    def read(self, words: Sequence[str]) -> argparse.Namespace:
        """Parse the words after the verb.

        Raises:
            Usage: They can't be parsed.
            Done: Help was requested, and has been shown.
        """
        if any(action.nargs == argparse.REMAINDER for action in self._actions):
            return self.parse_args(list(words))
        # Options may be anywhere, even before an optional positional.
        found, others = self.parse_known_intermixed_args(list(words))
        if others:
            raise self._refuse(others, found)
        return found

    def guess(self, words: Sequence[str]) -> tuple[argparse.Namespace, argparse.Action | None]:
        """Parse words that may be incomplete or wrong, without raising.

        Args:
            words: The words after the verb.

        Returns:
            The values known by argument name, and the argument that the next word belongs to.
        """
        options = {name: action for action in self._actions for name in action.option_strings}
        positionals = [action for action in self._actions if not action.option_strings]
        known = argparse.Namespace()
        waiting: argparse.Action | None = None
        several = False  # whether more words of the option may follow
        for word in words:
            if waiting is not None and not (several and word in options):
                setattr(known, waiting.dest, word)
                waiting = waiting if several else None
            elif word in options or word.startswith('--'):
                # An option may be abbreviated as long as it is unambiguous.
                meant = [action for name, action in options.items() if name.startswith(word)]
                action = options.get(word) or next(iter(meant), None)
                nargs = action.nargs if action is not None else 0
                waiting, several = action if nargs in (None, '+') else None, nargs == '+'
            elif (not word.startswith('-') or word == '-') and positionals:
                setattr(known, positionals[0].dest, word)
                if positionals[0].nargs not in ('+', '*', argparse.REMAINDER):
                    del positionals[0]
        return known, waiting or next(iter(positionals), None)

    def error(self, message: str) -> NoReturn:
        """Raise a `Usage` error; called by argparse."""
        with real_one(f'{self.usage_line}\n{self.prog}: error: {message}', code=2):
            raise Usage(
                f'{self.prog}: {message}', todo=self.usage_line, reason=Refusal.BAD_ARGUMENT
            )

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """End the line; called by argparse after showing help."""
        raise Done

    @property
    def usage_line(self) -> str:
        """The usage of the command, on one line."""
        words = [self.prog, '[options]']
        for action in self._actions:
            if not action.option_strings:
                name = str(action.metavar or action.dest)
                left_out = action.nargs in ('?', '*', argparse.REMAINDER)
                words += [f'[{name}]' if left_out else name]
        return f'usage: {" ".join(words)}'

    def _refuse(self, others: list[str], found: argparse.Namespace) -> Usage:
        options = [name for action in self._actions for name in action.option_strings]
        wrong = next((word for word in others if word.startswith('-')), '')
        if wrong:
            near = nearest(wrong.partition('=')[0], options)
            hint = f' Did you mean {near!r}?' if near else ''
            return Usage(
                f'{self.prog} has no option {quoted(wrong)}.{hint}',
                todo=self.usage_line,
                reason=Refusal.UNKNOWN_OPTION,
            )
        rest = ' '.join(others)
        hint, reason = '', Refusal.TOO_MANY_WORDS
        # Of `data: 1`, only the first word was taken as the YAML.
        if set(rest) & set('{}[]:') or str(getattr(found, 'values', '')).endswith(':'):
            hint = ' YAML goes in quotation marks: "{data: 1}"'
            reason = Refusal.QUOTES_MISSING
        return Usage(
            f'{self.prog}: {quoted(rest)} is too much.{hint}', todo=self.usage_line, reason=reason
        )


class _Refusing(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> NoReturn:
        why = str(self.help).partition(': ')[2]
        raise Usage(
            f'{parser.prog}: {self.option_strings[0]} is not here: {why}',
            reason=Refusal.UNKNOWN_OPTION,
        )


@dataclass(frozen=True)
class Verb:
    """One verb of a command, such as `list` of `ros2 topic list`.

    Attributes:
        summary: Its help text in the real `ros2`.
        run: Runs it. Returns None or 0 on success, another exit code, or an error message.
        arguments: Adds its arguments to a parser.
        note: Differences from the real verb, shown at the end of its help.
    """

    name: str
    summary: str
    run: Callable[[argparse.Namespace], str | int | None]
    arguments: Callable[[Parser], None] = lambda parser: None
    note: str = ''

    def parser(self, command: str) -> Parser:
        """Return the parser of the words after the verb."""
        prog = f'ros2 {command} {self.name}' if command != self.name else f'ros2 {command}'
        parser = Parser(prog, self.summary)
        parser.epilog = textwrap.fill(self.note, WIDTH)
        self.arguments(parser)
        return parser


@dataclass(frozen=True)
class Command:
    """One command, such as `topic`.

    Attributes:
        summary: Its help text in the real `ros2`.
        verbs: Its verbs. A command without verbs has itself as its only verb.
        options: Options allowed before the verb -> help text.
        elsewhere: Verbs of a full installation -> what they do.
    """

    name: str
    summary: str
    verbs: tuple[Verb, ...]
    options: dict[str, str] = field(default_factory=dict)
    elsewhere: dict[str, str] = field(default_factory=dict)

    @property
    def has_verbs(self) -> bool:
        """Whether a verb has to follow."""
        return [verb.name for verb in self.verbs] != [self.name]

    def verb(self, name: str) -> Verb:
        """Return a verb by its name.

        Raises:
            Usage: There is no such verb.
        """
        for verb in self.verbs:
            if verb.name == name:
                return verb
        names = [verb.name for verb in self.verbs]
        if name in self.elsewhere:
            raise Usage(
                f'ros2 {self.name} {name} is part of a full installation of ROS 2, but not of '
                f'this course. It {self.elsewhere[name]}.',
                reason=Refusal.UNKNOWN_VERB,
            )
        near = nearest(name, names)
        hint = f' Did you mean {near!r}?' if near else ''
        raise Usage(
            f'ros2 {self.name} has no verb {quoted(name)}.{hint}',
            todo=f'usage: ros2 {self.name} <verb>   with one of: {", ".join(sorted(names))}',
            reason=Refusal.UNKNOWN_VERB,
        )

    def help(self) -> str:
        """Return the help text, in the form of the real `ros2`."""
        options = {'-h, --help': 'show this help message and exit', **self.options}
        calls = f'Call `ros2 {self.name} <command> -h` for more detailed usage.'
        return '\n'.join(
            [
                f'usage: ros2 {self.name} [-h] <verb> ...',
                '',
                self.summary,
                '',
                'options:',
                *table(options.items()),
                '',
                'Commands:',
                *table((verb.name, verb.summary) for verb in self.verbs),
                '',
                f'  {calls}',
            ]
        )


def table(rows: Iterable[tuple[str, str]]) -> list[str]:
    """Return rows of word and meaning as sorted lines in two columns."""
    found = sorted(rows)
    width = max(len(word) for word, _ in found)
    return [f'  {word:{width}}  {text}' for word, text in found]


def unsigned_int(text: str) -> int:
    """Parse a whole number of at least 0."""
    return _int_from(text, 0)


def positive_int(text: str) -> int:
    """Parse a whole number of at least 1."""
    return _int_from(text, 1)


def positive_float(text: str) -> float:
    """Parse a finite number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f'expected a number above 0, but got {quoted(text)}')
    return value


def _int_from(text: str, least: int) -> int:
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if value < least:
        raise argparse.ArgumentTypeError(
            f'expected a whole number of at least {least}, but got {quoted(text)}'
        )
    return value


def _choice(choices: list[str]) -> Callable[[str], str]:
    def read(text: str) -> str:
        if text in choices:
            return text
        near = nearest(text, choices)
        hint = f'; did you mean {near!r}?' if near else ''
        known = ', '.join(choices)
        raise argparse.ArgumentTypeError(f'{quoted(text)} is not one of {known}{hint}')

    return read
