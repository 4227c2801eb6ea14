"""Texts with `$(...)`: the values are those of the real `launch`."""

import json
from pathlib import Path

import pytest

from labkit.errors import LabError
from labkit.launching.expressions import evaluate
from labkit.launching.model import Context, LaunchError, perform
from labkit.launching.templates import template

CASES = json.loads(Path(__file__).with_name('real_substitutions.json').read_text(encoding='utf-8'))


def performed(text: str) -> str:
    context = Context(launch_configurations={'x': 'X', 'y': 'x'})
    return perform(context, template(text))


@pytest.mark.parametrize(('text', 'value'), CASES)
def test_is_as_the_real_one(text: str, value: str | None):
    if value is None:
        with pytest.raises(LaunchError):
            performed(text)
    else:
        assert performed(text) == value


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('$(find-pkg-shre x)', 'Did you mean $(find-pkg-share)?'),
        ('$(var xx)', "launch configuration 'xx' does not exist"),
        ('$(var x', 'its ) is missing'),
        ('$(var  x)', 'one space'),
        ('$(find toys)', 'ROS 1; ROS 2 writes $(find-pkg-share package)'),
        ('$(arg x)', 'ROS 2 writes $(var name)'),
        ('$(command lab_none)', "The command 'lab_none' can not be run"),
        ("$(command 'sh -c \\'echo why 1>&2; exit 3\\'')", 'exit code 3.\nwhy'),
        ("$(command 'sh -c \\'echo why 1>&2\\'')", "on_stderr='warn'"),
        ("$(command 'echo a' loudly)", 'on_stderr is one of fail, ignore'),
        ('$(eval 1 + 2)', '1 to 2 arguments, and has 3'),
        ('$(env LAB_NOT_THERE)', 'does not exist'),
        ('$(find-exec lab_not_there)', 'not found on the PATH'),
        ('$(file-content /lab/not/there)', 'can not be read'),
        ('$(find-pkg-share lab_not_there)', "Package 'lab_not_there' not found"),
        ("$(var x 'a", "a quotation mark ' is missing"),
    ],
)
def test_a_fault_is_named(text: str, words: str):
    with pytest.raises(LabError) as caught:
        performed(text)
    assert words in str(caught.value)


def test_a_name_is_found_that_is_near():
    with pytest.raises(LaunchError, match="Did you mean 'robot_name'"):
        perform(Context(launch_configurations={'robot_name': ''}), template('$(var robotname)'))


def test_any_and_all():
    assert performed('$(any false true)') == 'true'
    assert performed('$(all true true false)') == 'false'


def test_anon_is_the_same_in_one_launch_and_another_name_for_another():
    assert performed('$(anon a)') == performed('$(anon a)') != performed('$(anon b)')


@pytest.mark.parametrize(
    'expression',
    [
        '__import__("os").system("true")',
        'open("/etc/passwd")',
        '().__class__',
        '[x for x in [1]]',
        'lambda: 1',
        '2 ** 10 ** 9',
        '"a" * 10 ** 9',
        '10 ** 9 * "a"',
        '[0] * 10 ** 9',
        '"%999999999d" % 1',
        '9 ** 9 ** 9',
        '(2 ** 9000) ** 2',
        '1 if x else 2',
        'a := 1',
        'b"x"',
        '1j',
        '...',
        '(' * 300 + ')' * 300,
        '-' * 20000 + '1',
        '1 << 10 ** 9',
        'f"{1:999999999}"',
        'f"{1!r}"',
        '"%*d" % (9999999, 1)',
        '"%.9999999f" % 1',
        '("a" * 9999).replace("a", "b" * 9999)',
        '("a" * 9999).join(["b"] * 9999)',
        '"{:>999999999}".format(1)',
        'round(1, -10 ** 9)',
        'factorial(10 ** 9)',
        'math.comb(10 ** 9, 10 ** 8)',
        'math.__doc__',
        '"a".__class__',
        '{**{1: 2}}',
        'sin(x for x in [1])',
        'pi(3)',
        'sum([2 ** 9000] * 9000)',
        'open',
        '"' + 'a' * 9000 + '" * 2',
        "'a' 'b",
        '1 in 2',
        '',
    ],
)
def test_anything_else_is_refused_in_a_sentence(expression: str):
    with pytest.raises(LaunchError):
        evaluate(expression)


def test_the_largest_that_is_allowed_takes_no_time():
    assert evaluate('2 ** 4000 > 0') == 'True'
    assert len(evaluate('"ab" * 5000')) == 10_000
