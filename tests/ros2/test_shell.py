"""How a line of `ros2` is taken apart, and what is said of one that can't be understood."""

from __future__ import annotations

import hypothesis.strategies as st
import pytest
from hypothesis import HealthCheck, given, settings

from labkit.ros2.completion import complete_line
from labkit.ros2.parser import Done, Usage
from labkit.ros2.shell import COMMANDS, command, history, run_line, split

VERBS = [verb.name for name in COMMANDS for verb in command(name).verbs]
OPTIONS = sorted(
    {
        option
        for name in COMMANDS
        for verb in command(name).verbs
        for action in verb.parser(name).actions
        for option in action.option_strings
    }
)
VALUES = [
    *('/chatter', '/odom', 'std_msgs/msg/String', 'std_msgs/Int16', '"{data: 1}"', "'data: x'"),
    *('{data:', '1}', '"', "'", '|', '#', '--', '-', '', '0', '-1', '1e309', 'nan', '𝄞', '\\'),
    *('"{[}"', '"&a [*a]"', '"!!python/object:os.system {}"', '../..', '/', '~', '$(x)', '*'),
]


@pytest.mark.parametrize(
    ('line', 'words'),
    [
        ('topic list', ['topic', 'list']),
        ('  topic   list  ', ['topic', 'list']),
        ('topic pub /x T "{data: 1}"', ['topic', 'pub', '/x', 'T', '{data: 1}']),
        ('topic pub /x T \'{data: "a b"}\'', ['topic', 'pub', '/x', 'T', '{data: "a b"}']),
        ('topic list  # all of them', ['topic', 'list']),
        ('topic pub /x T "#1"', ['topic', 'pub', '/x', 'T', '#1']),
        ('topic pub /x T "|"', ['topic', 'pub', '/x', 'T', '|']),
        ('', []),
    ],
)
def test_split(line, words):
    assert split(line) == words


@pytest.mark.parametrize(
    ('line', 'sentence'),
    [
        ('topic list "', 'A quotation mark'),
        ('topic list | grep x', "'|' belongs to a terminal"),
        ('topic list > file', "'>' belongs to a terminal"),
        ('topic list; node list', "';' belongs to a terminal"),
    ],
)
def test_what_only_a_terminal_can_do(line, sentence):
    with pytest.raises(Usage, match=sentence.replace('|', r'\|')):
        split(line)


@pytest.mark.parametrize(
    ('line', 'signs'),
    [
        ('topic pub /a std_msgs/msg/String “data: hello”', '“ and ”'),
        ('topic pub /a std_msgs/msg/Int16 ‘{data: 5}’', '‘ and ’'),
        ("topic pub /a std_msgs/msg/Int16 '{data: „5“}'", '„ and “'),
        ('topic info "/chatter”', '”'),
        ('topic list –t', '–'),
        ('topic echo —once', '—'),
        ('topic\u00a0list', 'U+00A0 (no plain space)'),
        ('topik list', None),
        ("topic pub /a std_msgs/msg/Int16 '{data: the dogs‘s}'", None),
        ("topic pub /a std_msgs/msg/Int16 '{data: 3–5}'", None),
    ],
)
def test_signs_that_a_page_has_made_are_named(capsys, line, signs):
    assert run_line(line) != 0
    shown = capsys.readouterr().err
    if signs is None:
        assert 'In this line' not in shown
    else:
        assert f'\nIn this line is {signs}, as pages' in shown
    assert history[-1].complaint + '\n' == shown


@pytest.mark.parametrize(
    ('line', 'answer'),
    [
        (
            'topik list',
            "ros2 has no command 'topik'. Did you mean 'topic'?\n"
            'usage: ros2 <command>   with one of: ',
        ),
        (
            'topic lsit',
            "ros2 topic has no verb 'lsit'. Did you mean 'list'?\n"
            'usage: ros2 topic <verb>   with one of: bw, delay, echo, find, hz, info, list, pub, '
            'type\n',
        ),
        (
            'topic list --shwo-types',
            "ros2 topic list has no option '--shwo-types'. Did you mean '--show-types'?\n"
            'usage: ros2 topic list [options]\n',
        ),
        (
            'topic info',
            'ros2 topic info: the following arguments are required: topic_name\n'
            'usage: ros2 topic info [options] topic_name\n',
        ),
        (
            'topic info /a /b',
            "ros2 topic info: '/b' is too much.\nusage: ros2 topic info [options] topic_name\n",
        ),
        (
            'topic --hidden list',
            "ros2 topic has no option '--hidden'.",
        ),
        (
            'daemon status',
            'ros2 daemon is part of a full installation of ROS 2, but not of this course. It '
            'starts and stops a process',
        ),
        ('daemon stop', 'ros2 daemon is part of a full installation'),
        ('multicast send', 'ros2 multicast is part of a full installation'),
        ('component list', 'ros2 component is part of a full installation'),
        ('param set /lamp speed \udcff', "'\\udcff' is no text in UTF-8."),
        ('topic list -a', "ros2 topic list has no option '-a'."),
    ],
)
def test_wrong_words_get_a_sentence_and_the_usage_line(capsys, line, answer):
    assert run_line(line) == 2
    shown = capsys.readouterr()
    assert shown.out == ''
    assert shown.err.startswith(answer)


@pytest.mark.parametrize('line', ['', '-h', 'topic', 'topic -h', 'topic list -h', 'run -h'])
def test_help(capsys, line):
    assert run_line(line) == 0
    shown = capsys.readouterr()
    assert shown.out.startswith('usage: ros2') and shown.err == ''


@pytest.mark.parametrize(
    ('verb', 'words'),
    [
        ('param set', 'exit code 1'),
        ('param delete', 'exit code 1'),
        ('param describe', 'exit code 1'),
        ('param load', 'another node'),
        ('topic find', 'exit code 1'),
        ('service find', 'exit code 1'),
        ('topic echo', 'exit code 1'),
        ('topic pub', 'exit code 1'),
        ('topic type', 'exit code 1'),
        ('service call', 'exit code 1'),
        ('doctor', 'exit code 1'),
    ],
)
def test_help_says_where_a_verb_is_stricter_than_the_real_one(capsys, verb, words):
    assert run_line(f'{verb} -h') == 0
    shown = capsys.readouterr().out
    last = shown[shown.rindex('\n\n') :]
    assert max(map(len, last.splitlines())) <= 88
    note = ' '.join(last.split())
    assert 'the real one' in note and words in note


def lines():
    """Return lines that are nearly right, and some that are not at all."""
    words = st.sampled_from([*COMMANDS, *VERBS, *OPTIONS, *VALUES]) | st.text(max_size=8)
    right = st.tuples(
        st.sampled_from(
            [f'{name} {verb.name}' for name in COMMANDS for verb in command(name).verbs]
        ),
        st.lists(words, max_size=6),
    ).map(lambda parts: ' '.join([parts[0], *parts[1]]))
    return right | st.lists(words, max_size=8).map(' '.join) | st.text(max_size=60)


def read(line: str) -> None:
    """Do with a line all that is done before its verb runs."""
    words = split(line)
    if words:
        chosen = command(words[0])
        if chosen.has_verbs and len(words) > 1:
            chosen.verb(words[1]).parser(chosen.name).read(words[2:])
        elif not chosen.has_verbs:
            chosen.verbs[0].parser(chosen.name).read(words[1:])


@pytest.mark.slow('thousands of lines')
@settings(
    max_examples=10_000, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)
@given(lines())
def test_no_other_exception_escapes_the_parser(capsys, line):
    try:
        read(line)
    except (Usage, Done):
        pass
    capsys.readouterr()


# Files, the graph of this process, or nothing is asked, so these end by themselves.
ENDING = [
    *('interface show', 'interface proto', 'interface package', 'interface list', 'pkg prefix'),
    *('pkg executables', 'pkg xml', 'topic list', 'topic info', 'topic type', 'topic find'),
    *('node list', 'node info', 'service list', 'service type', 'service find', 'param list'),
    *('param get', 'param set', 'param describe', 'param dump', 'param load', 'doctor'),
]


@pytest.mark.slow('dozens of command lines')
@settings(
    max_examples=1_000, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)
@given(
    st.sampled_from(ENDING),
    st.lists(st.sampled_from([*OPTIONS, *VALUES]) | st.text(max_size=8), max_size=4),
)
def test_every_line_ends_with_a_code_and_no_traceback(capsys, start, words):
    assert run_line(' '.join([start, *words])) in (0, 1, 2)
    assert 'Traceback' not in capsys.readouterr().err


@pytest.mark.slow('thousands of lines')
@settings(
    max_examples=1_000, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)
@given(lines())
def test_completion_never_fails(line):
    assert isinstance(complete_line(line)[1], list)
