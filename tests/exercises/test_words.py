"""The words of modules: what a file of them may say, and that all of them are said."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from labkit import settings
from labkit.errors import LabError
from labkit.exercises import learner_errors, mistakes, words
from labkit.exercises.figures import figure, many
from labkit.exercises.words import TRANSLATIONS, Words, files, lacking, words_of

LABKIT = Path(__file__).resolve().parent.parent.parent / 'labkit'
# The name of `**values` in a call.
UNTOLD = 'None'
# Written in the way that a docstring of `words` shows.
EVENS = """
task: Add {step}.
clauses:
  answers: each number plus {step}
hints:
  - Add {step} to {{it}}.
  - Publish.
reason: >-
  One goes out
  for each one.
mistakes:
  test-evens/no:
    why: no
    todo: Add {more}.
    change:
      "        data\\n": ''
      data + 1: abs(data) + 1
    raises: "{'data'}"
"""


@pytest.fixture(autouse=True)
def own_mistakes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no other test of this process know the mistakes that are made here."""
    monkeypatch.setattr(mistakes, '_known', dict(mistakes.known_mistakes()))


def told(folder: Path, text: str) -> Words:
    (folder / 'evens.yaml').write_text(text)
    return words_of(str(folder / 'evens.py'))


def test_words_are_texts_with_the_values_of_the_module(tmp_path: Path) -> None:
    evens = told(tmp_path, EVENS).of(step=1)
    assert evens.task == 'Add 1.'
    assert evens.clause('answers') == 'each number plus 1'
    assert evens.hints == ['Add 1 to {it}.', 'Publish.']
    assert evens.reason == 'One goes out for each one.'
    mistake = evens.mistake('test-evens/no', lambda n: n + 1)
    assert (mistake.why, mistake.of(more=2.50).step) == ('no', 'Add 2.5.')
    assert mistake.change == [('        data\n', ''), ('data + 1', 'abs(data) + 1')]
    assert (mistake.raises, mistake.answer(1)) == ("{'data'}", 2)


@pytest.mark.parametrize(
    ('text', 'line', 'said'),
    [
        ('task: a\nhint:\n  - b', 2, "the file has no 'hint'.\nDid you mean 'hints'?"),
        ('mistakes:\n  a/b:\n    wy: c', 3, "a/b has no 'wy'.\nDid you mean 'why'?"),
        ('mistakes:\n  a/b:\n    number: c', 3, 'It may have why, todo, change, raises.'),
        ('mistakes:\n  a/b: c', 2, 'a/b has to be a mapping'),
        ('hints: a', 1, 'hints has to be a list'),
        ('task:\n  - a', 2, 'task has to be a text'),
        ('task: a\ntask: b', 2, "'task' stands there twice"),
        ('task: a: b', 1, 'is not YAML: mapping values are not allowed'),
        ('task: a\nreason: {b}', 2, 'reason has to be a text'),
        ('task: a\nreason: of {b.c}', 2, 'the braces of reason hold no name'),
        ('task: of {b[0]}', 1, 'the braces of task hold no name'),
        ('task: in {a:.3g} s', 1, 'the braces of task hold no name'),
        ('hints:\n  - msg = {}', 2, 'the braces of hints hold no name'),
        ('task: !!python/object:os.system {}', 1, 'task has to be a text'),
        ('? [a]\n: b', 1, 'the file has no'),
    ],
)
def test_wrong_file_is_refused_with_its_line(
    tmp_path: Path, text: str, line: int, said: str
) -> None:
    with pytest.raises(LabError) as caught:
        told(tmp_path, text)
    message = str(caught.value)
    assert f'evens.yaml, line {line}: ' in message and said in message


def test_what_is_not_written_is_named_with_what_is(tmp_path: Path) -> None:
    evens = told(tmp_path, EVENS)
    for ask, said in (
        (lambda: evens.mistake('test-evens/not'), "no mistake 'test-evens/not'"),
        (lambda: evens.clause('answer'), "no clause 'answer'"),
        (lambda: told(tmp_path, 'task: a').reason, "no 'reason'"),
        (lambda: evens.task, "'task' of .*evens.yaml lacks a value for 'step'"),
    ):
        with pytest.raises(LabError, match=said):
            ask()
    with pytest.raises(LabError, match=r'(?s)evens\.yaml.*No such file'):
        words_of(str(tmp_path / 'absent' / 'evens.py'))


def test_tower_of_lists_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LabError, match='nested too deep'):
        told(tmp_path, 'task: ' + '[' * 100_000)


GERMAN = """
task: Zähle {step} dazu.
hints:
  - Zähle {step} zu {{it}}.
mistakes:
  test-german/no:
    why: nein
    change:
      data + 1: data
  test-german/old:
    why: weg
"""


def test_another_language_is_a_folder_of_the_same_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(words, 'ROOT', tmp_path)
    monkeypatch.setattr(words, 'TRANSLATIONS', tmp_path / 'translations')
    monkeypatch.setenv('LABKIT_LANGUAGE', 'de')
    lesson, other = (tmp_path / name for name in ('lessons', 'translations/de/lessons'))
    lesson.mkdir()
    other.mkdir(parents=True)
    (other / 'evens.yaml').write_text(GERMAN)
    found = told(lesson, EVENS.replace('test-evens', 'test-german')).of(step=1)
    assert (found.task, found.hints) == ('Zähle 1 dazu.', ['Zähle 1 zu {it}.', 'Publish.'])
    assert found.clause('answers') == 'each number plus 1'
    mistake = found.mistake('test-german/no')
    assert (mistake.why, mistake.todo) == ('nein', 'Add {more}.')
    assert dict(mistake.change)['data + 1'] == 'abs(data) + 1'
    file = str(Path('lessons', 'evens.yaml'))
    assert lacking('de') == [
        f"{file} clauses.answers: lacks 'each number plus {{step}}'",
        f"{file} hints.2: lacks 'Publish.'",
        f"{file} reason: lacks 'One goes out for each one.'",
        f"{file} mistakes.test-german/no.todo: lacks 'Add {{more}}.'",
        f'{file} mistakes.test-german/old.why: is not in English',
    ]
    assert len(lacking('fr')) == 7


@pytest.mark.parametrize('name', ['', '../de', 'd e', 'ü'])
def test_language_is_the_name_of_a_folder(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('LABKIT_LANGUAGE', name)
    assert settings.language() == ''


def test_no_language_lacks_a_sentence() -> None:
    found = [line for each in TRANSLATIONS.glob('*') for line in lacking(each.name)]
    assert not found, '\n'.join(found)


def trees() -> dict[Path, ast.Module]:
    """Return the modules that examine, parsed."""
    paths = [p for room in ('exercises', 'lessons') for p in (LABKIT / room).rglob('*.py')]
    return {p: ast.parse(p.read_text()) for p in sorted(paths) if p.parent.name != 'solutions'}


@pytest.mark.parametrize('path', files(), ids=lambda path: path.stem)
def test_all_that_is_written_is_used(path: Path) -> None:
    module = path.with_suffix('.py')
    assert module.exists(), f'{path} is the words of no module'
    said, tree = words_of(str(module)), ast.parse(module.read_text())
    literals = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    # A program that raises an error is told by the error: no judge looks for it.
    written = [name for name, mistake in said.mistakes.items() if not mistake.raises]
    written += said.data.get('clauses', {})
    written += said.data.get('quizzes', {})
    assert [name for name in written if name not in literals] == []
    if {'task', 'hints', 'reason'} & said.data.keys():
        assert re.search(r'\bExercise\(\s*words=', module.read_text())


def constants(tree: ast.Module) -> dict[str, str]:
    """Return the ids of the mistakes that stand in a module by a name."""
    return {
        target.id: node.value.args[0].value
        for node in tree.body
        if isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Call)
        and ast.unparse(node.value.func) == 'WORDS.mistake'
        and isinstance(node.value.args[0], ast.Constant)
        for target in node.targets
        if isinstance(target, ast.Name)
    }


def gives(tree: ast.Module) -> dict[str, set[str]]:
    """Return the names of the values that mistakes get, by the expression that gets them."""
    given: dict[str, set[str]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith('.of'):
            names = {str(each.arg) for each in node.keywords}
            given.setdefault(ast.unparse(node.func)[: -len('.of')], set()).update(names)
    return given


def test_values_of_a_sentence_are_those_that_the_code_gives() -> None:
    found = trees()
    fields = {
        name: set(re.findall(r'(?<!\{)\{(\w+)', mistake.why + mistake.todo))
        for path in files()
        for name, mistake in words_of(str(path.with_suffix('.py'))).mistakes.items()
    }
    common = constants(found[LABKIT / 'exercises' / 'common_mistakes.py'])
    wrong = []
    for path, tree in found.items():
        known = {f'common_mistakes.{name}': each for name, each in common.items()}
        known |= constants(tree)
        given = gives(tree)
        # Where several mistakes meet in a variable, each gets the values of all.
        later = set().union(*(names for name, names in given.items() if name not in known))
        used = {
            ast.unparse(node)
            for node in ast.walk(tree)
            if isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Load)
        }
        for name in used & known.keys():
            own, wanted = given.get(name, set()), fields[known[name]]
            # What `**told` gives is not in the code: there a run tells.
            if UNTOLD not in own | later and not wanted - later <= own <= wanted:
                wrong.append(f'{path.name}: {known[name]} says {wanted}, and gets {own | later}')
    assert not wrong, '\n'.join(wrong)


def test_values_of_an_error_are_those_that_its_pattern_finds() -> None:
    for _, pattern, mistake in learner_errors._KNOWN:
        fields = set(re.findall(r'(?<!\{)\{(\w+)', mistake.why + mistake.todo))
        assert fields <= set(re.compile(pattern).groupindex), mistake.id


@pytest.mark.parametrize(
    ('number', 'text'),
    [
        (2000.0, '2000'),
        (2013.4, '2013'),
        (12.345, '12.3'),
        (0.5, '0.5'),
        (1 / 3, '0.333'),
        (0.1 + 0.2, '0.3'),
        (1e-5, '0.00001'),
        (-0.05, '-0.05'),
        (0.0, '0'),
        (1e9, '1000000000'),
        (float('inf'), 'inf'),
        (float('nan'), 'nan'),
    ],
)
def test_number_is_written_as_people_write_it(number: float, text: str, tmp_path: Path) -> None:
    assert figure(number) == text
    words = told(tmp_path, 'task: Wait {seconds} s.').of(seconds=number)
    assert words.task == f'Wait {text} s.'


def test_count_has_its_noun() -> None:
    assert [many(n, 'message') for n in (0, 1, 2)] == ['0 messages', '1 message', '2 messages']


# Numbers with all of their digits, or with a power of ten; and a count with its noun's plural.
_UNREAD = (
    r'\{[^{}]*:(\.\d)?[ge]\}',
    r'\{(?!steps|least|wanted)[a-z][^{}]*\} (messages|commands|steps|files|lines|pauses)\b',
)


JUDGES = [
    *(LABKIT / 'lessons').rglob('*.py'),
    *(LABKIT / 'exercises' / 'clauses').glob('*.py'),
]


@pytest.mark.parametrize('path', [pytest.param(path, id=path.stem) for path in sorted(JUDGES)])
def test_judge_writes_numbers_by_the_one_function(path: Path) -> None:
    source = path.read_text(encoding='utf-8')
    found = [match.group() for pattern in _UNREAD for match in re.finditer(pattern, source)]
    assert found == []
