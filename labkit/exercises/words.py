"""The words of a module: what a learner reads, in a YAML file beside it.

The words of `evens.py` are in `evens.yaml`. A judge is Python, and what it says is data, which a
teacher reads, mends and translates without writing any. All keys may be left out::

    task: Subscribe to /odds, and publish each number plus {step} on /evens.
    clauses:
      answers: for each number on `/odds`, publish that number plus {step}
    hints:
      - One node may have a publisher and a subscription.
    reason: For each message that comes, one goes out.
    mistakes:
      evens/passed-on:
        why: The number is passed on as it came.
        todo: Add {step} to msg.data.
        change:
          msg.data + 1: msg.data

A name in braces is a value that the module gives; `{name!r}` puts it into quotation marks. Numbers
are written as people do (`figures`), without a word about it. A brace to be read is doubled; but
not in `change` and `raises`, which are code, and what Python says, nor in quizzes.
Every value is a text: `no` and `1.0` are letters. `Mistake` and `Question` tell what their parts
mean. A quiz is a list of questions::

    quizzes:
      odds:
        - choice: What does msg + 1 give?
          options:
            - right: an error
              why: A message is not a number.
            - wrong: a number
              why: The number is msg.data + 1.
        - number: How many nodes publish on /odds at this moment?
          id: publishers
          why: The graph says so.
          otherwise: Ask the graph.

What a cell will show may be guessed before it is run::

    guesses:
      late:
        ask: Five letters are sent, and then somebody subscribes. How many do they hear?
        options:
          - none
          - all five
        came: none
        why: What was sent before is gone.
        shown_by: late-listener

The files beside the modules are English. Another language is a folder of files of the same names,
`translations/de/lessons/odds/evens.yaml`, with the same keys and the sentences only. What it lacks
stays English; `lacking` tells what that is.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from labkit import settings
from labkit.errors import LabError, did_you_mean
from labkit.exercises.figures import filled
from labkit.exercises.mistakes import Mistake
from labkit.files import read_limited

__all__ = ['TRANSLATIONS', 'Words', 'files', 'lacking', 'sentences', 'words_of']

ROOT = Path(__file__).resolve().parent.parent
TRANSLATIONS = ROOT / 'translations'
# Deeper than any form of a file.
MAX_DEPTH = 20
# What a file may hold: a text, or one as it is; a list of one form; a mapping of one, or of named
# ones.
_TEXT, _RAW = 'text', 'raw'
_MISTAKE = {'why': _TEXT, 'todo': _TEXT, 'change': {'': _RAW}, 'raises': _RAW}
# What is the same in each language.
_SAME = ('answer', 'change', 'id', 'raises', 'shown_by', 'tolerance')
# Its kind, with the text; see `Question`.
_QUESTION = {
    **dict.fromkeys(('choice', 'several', 'number', 'word'), _RAW),
    'options': [dict.fromkeys(('right', 'wrong', 'why'), _RAW)],
    **dict.fromkeys(('id', 'answer', 'unit', 'tolerance', 'how', 'why', 'otherwise'), _RAW),
    'wrong': {'': _RAW},
}
# See `Guess`.
_GUESS = {**dict.fromkeys(('ask', 'came', 'why', 'shown_by'), _RAW), 'options': [_RAW]}
_FILE = {
    'task': _TEXT,
    'clauses': {'': _TEXT},
    'hints': [_TEXT],
    'reason': _TEXT,
    'mistakes': {'': _MISTAKE},
    'quizzes': {'': [_QUESTION]},
    'guesses': {'': _GUESS},
}
# What braces may hold: a name, and whether it is quoted; nothing is looked up or computed. How a
# number is written, `figures` knows.
_FIELD = re.compile(r'\{\{|\}\}|\{[a-z]\w*(!r)?\}')


@dataclass(frozen=True)
class Words:
    """The words of one module.

    Attributes:
        path: The file.
        data: What it says.
        mistakes: Its mistakes, by their ids.
        values: What stands for the names in braces; mistakes have values of their own.
    """

    path: Path
    data: Mapping[str, Any]
    mistakes: Mapping[str, Mistake]
    values: Mapping[str, Any] = field(default_factory=dict)

    def of(self, **values: Any) -> Words:
        """Return them with values for the names in braces."""
        return replace(self, values={**self.values, **values})

    @property
    def task(self) -> str:
        """The task of the exercise."""
        return self._filled('task', self._part('task', self.data))

    @property
    def hints(self) -> list[str]:
        """Its hints."""
        return [self._filled('hints', hint) for hint in self._part('hints', self.data)]

    @property
    def reason(self) -> str:
        """The explanation of its solution."""
        return self._filled('reason', self._part('reason', self.data))

    def clause(self, name: str) -> str:
        """Return the words of a clause."""
        return self._filled(name, self._part(name, self.data.get('clauses', {}), 'clause '))

    def mistake(self, name: str, model: Callable[..., Any] | None = None) -> Mistake:
        """Return a mistake by its id, with a model of what a program with it answers.

        Raises:
            LabError: It has no words.
        """
        found: Mistake = self._part(name, self.mistakes, 'mistake ')
        return found if model is None else replace(found, model=model)

    def _part(self, name: str, among: Mapping[str, Any], what: str = '') -> Any:
        if name not in among:
            raise LabError(
                f'{self.path} has no {what}{name!r}, which its module asks for.',
                todo=did_you_mean(name, among),
            )
        return among[name]

    def _filled(self, name: str, text: str) -> str:
        try:
            return filled(text, self.values)
        except KeyError as error:
            raise LabError(f'{name!r} of {self.path} lacks a value for {error}.') from error


def words_of(module: str) -> Words:
    """Return the words of a module, which are beside it.

    Args:
        module: `__file__` of the module.

    Raises:
        LabError: The file can't be read, or it is not what words are. The message names the line.
    """
    path = Path(module).with_suffix('.yaml')
    data = _read(path)
    other = _translation(path, settings.language())
    if other is not None:
        data = _merged(data, _read(other))
    mistakes = {
        name: Mistake(
            name,
            parts.get('why', ''),
            parts.get('todo', ''),
            change=list(parts.get('change', {}).items()),
            raises=parts.get('raises', ''),
        )
        for name, parts in data.get('mistakes', {}).items()
    }
    return Words(path, data, mistakes)


def files() -> list[Path]:
    """Return the files of words of the course, in English."""
    rooms = (ROOT / 'exercises', ROOT / 'lessons')
    return sorted(path for room in rooms for path in room.rglob('*.yaml'))


def sentences(path: Path) -> dict[str, str]:
    """Return what a learner can read of a file of words, by keys such as `'hints.2'`."""
    return dict(_sentences(_read(path)))


def lacking(language: str) -> list[str]:
    """Return what a language lacks, and what it has that English has not: a line for each."""
    found = []
    for path in files():
        other = _translation(path, language)
        here, there = sentences(path), sentences(other) if other is not None else {}
        name = path.relative_to(ROOT)
        found += [f'{name} {key}: lacks {here[key]!r}' for key in here if key not in there]
        found += [f'{name} {key}: is not in English' for key in there if key not in here]
    return found


def _translation(path: Path, language: str) -> Path | None:
    """Return the file with the same words in another language, None if there is none."""
    if not language or not path.is_relative_to(ROOT):
        return None
    other = TRANSLATIONS / language / path.relative_to(ROOT)
    return other if other.exists() else None


def _sentences(data: Any, key: str = '') -> Iterator[tuple[str, str]]:
    if isinstance(data, str):
        yield key, data
        return
    pairs = data.items() if isinstance(data, Mapping) else enumerate(data, start=1)
    for name, part in pairs:
        if name not in _SAME:
            yield from _sentences(part, f'{key}.{name}' if key else str(name))


def _merged(data: Any, other: Any) -> Any:
    """Return words with the sentences of another language in their places, as far as it goes."""
    if isinstance(data, Mapping):
        return {
            name: _merged(part, other[name]) if name in other and name not in _SAME else part
            for name, part in data.items()
        }
    if isinstance(data, list):
        return [*map(_merged, data, other), *data[len(other) :]]
    return other


def _read(path: Path) -> Mapping[str, Any]:
    """Return what a file of words says."""
    try:
        text = read_limited(path).decode()
        depth = 0
        for event in yaml.parse(text, Loader=yaml.CSafeLoader):
            depth += isinstance(event, yaml.CollectionStartEvent)
            depth -= isinstance(event, yaml.CollectionEndEvent)
            if depth > MAX_DEPTH:  # libyaml's composer ends the process where a stack ends
                raise _wrong(path, event.start_mark, 'is nested too deep')
        root = yaml.compose(text, Loader=yaml.CSafeLoader)
    except (OSError, UnicodeDecodeError) as error:
        raise LabError(f'The words of a module can not be read in {path}: {error}') from error
    except yaml.MarkedYAMLError as error:
        raise _wrong(path, error.problem_mark, f'is not YAML: {error.problem}') from error
    data: Mapping[str, Any] = {} if root is None else _formed(root, _FILE, path, 'the file')
    return data


def _formed(node: yaml.Node, form: Any, path: Path, name: str) -> Any:
    """Return what a node says, which has to have a form. No tag of YAML means anything."""
    if isinstance(form, dict) and isinstance(node, yaml.MappingNode):
        found: dict[str, Any] = {}
        for key, value in node.value:
            inner = form.get('') or form.get(str(key.value))
            if inner is None:
                todo = did_you_mean(str(key.value), form, f'It may have {", ".join(form)}.')
                raise _wrong(path, key.start_mark, f'{name} has no {key.value!r}', todo)
            if str(key.value) in found:
                raise _wrong(path, key.start_mark, f'{key.value!r} stands there twice')
            found[str(key.value)] = _formed(value, inner, path, str(key.value))
        return found
    if isinstance(form, list) and isinstance(node, yaml.SequenceNode):
        return [_formed(each, form[0], path, name) for each in node.value]
    if isinstance(form, str) and isinstance(node, yaml.ScalarNode):
        if form == _TEXT and set(_FIELD.sub('', node.value)) & set('{}'):
            todo = 'Write {name} or {name!r}, and no more, or {{ for a brace to be read.'
            raise _wrong(path, node.start_mark, f'the braces of {name} hold no name', todo)
        return node.value
    kind = {'str': 'text', 'list': 'list', 'dict': 'mapping'}[type(form).__name__]
    raise _wrong(path, node.start_mark, f'{name} has to be a {kind}')


def _wrong(path: Path, mark: Any, what: str, todo: str = '') -> LabError:
    line = f', line {mark.line + 1}' if mark is not None else ''
    return LabError(f'Words in {path}{line}: {what}.', todo=todo)
