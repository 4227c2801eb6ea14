"""`ros2 param` against a foreign node."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.usefixtures('robot')

NAMES = ['names', 'pid.p', 'speed', 'start_type_description_service', 'use_sim_time']
DUMP = """\
/lamp:
  ros__parameters:
    names:
    - a
    - b
    pid:
      p: 1.5
    speed: 5
    start_type_description_service: true
    use_sim_time: false

"""


def test_read(ros2):
    every, names, types, number, text, bare, dump, described = ros2(
        'param list',
        'param list /lamp',
        'param list lamp --param-type',
        'param get /lamp speed',
        'param get /lamp names',
        'param get /lamp speed --hide-type',
        'param dump /lamp',
        'param describe /lamp speed pid.p',
    )
    assert every.lines[0] == '/fleet/robot:'
    assert every.lines[-6:] == ['/lamp:', *(f'  {name}' for name in NAMES)]
    assert names.lines == [f'  {name}' for name in NAMES]
    assert types.lines[:2] == ['  names (type: string array)', '  pid.p (type: double)']
    assert number.out == 'Integer value is: 5\n'
    assert text.out == "String values are: ['a', 'b']\n"
    assert bare.out == '5\n'
    assert dump.out == DUMP
    assert described.lines == [
        'Parameter name: speed',
        '  Type: integer',
        '  Description: how fast',
        '  Constraints:',
        '    Min value: 0',
        '    Max value: 10',
        '    Step: 1',
        'Parameter name: pid.p',
        '  Type: double',
        '  Constraints:',
    ]


def test_a_parameter_without_a_value_hides_no_other(script, domain):
    code = """
import contextlib, io
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
import labkit as lab
from labkit.ros2.shell import run_line
class Tub(Node):
    def __init__(self):
        super().__init__('tub')
        self.declare_parameter('b.size', 3)
        self.declare_parameter('b.place', Parameter.Type.STRING)
        self.declare_parameter('a')
lab.spin(Tub())
err = io.StringIO()
with contextlib.redirect_stderr(err):
    code = run_line('param dump /tub')
print([code, err.getvalue()])
"""
    result = script(code, **domain)
    assert '    b:\n      size: 3\n    start_type_description_service: true\n' in result.stdout
    assert 'place' not in result.stdout.partition('[')[0] and '    a' not in result.stdout
    assert "[0, 'Left out, as without a value: a, b.place\\n']" in result.stdout


@pytest.mark.slow('starts other processes')
def test_names_can_be_filtered(ros2):
    every, one, nothing, wrong = ros2(
        'param list --filter "pid|sp"',
        'param list /lamp --filter ".*sim"',
        'param list /lamp --filter im',
        'param list /lamp --filter "("',
    )
    # From the beginning of the name; a node that has none is left out.
    assert every.lines == ['/lamp:', '  pid.p', '  speed']
    assert one.lines == ['  use_sim_time']
    assert (nothing.code, nothing.out) == (0, '')
    assert (wrong.code, wrong.out) == (2, '') and 'no regular expression' in wrong.err


@pytest.mark.slow('starts other processes')
def test_a_file_for_another_node_is_refused(ros2, tmp_path):
    names = 'other', 'empty', 'no_node', 'for_all'
    other, empty, no_node, for_all = (tmp_path / name for name in names)
    other.write_text(DUMP.replace('/lamp', '/talker'))
    empty.write_text('{}')
    no_node.write_text('/lamp: {speed: 5}')
    for_all.write_text(DUMP.replace('/lamp', '/**'))
    files = other, empty, no_node, f'{for_all} --no-use-wildcard'
    answers = ros2(*(f'param load /lamp {path}' for path in files))
    assert [(answer.code, answer.out) for answer in answers] == [(1, '')] * 4
    # The words of rclpy.
    assert answers[0].err == (
        "Param file does not contain parameters for /lamp, only for nodes: ['/talker']\n"
    )
    assert answers[1].err == 'Param file does not contain selected parameters\n'
    assert answers[2].err == 'YAML file is not a valid ROS parameter file for node /lamp\n'
    assert answers[3].err == (
        'Param file does not contain selected parameters\n'
        'It has some for all nodes, which --no-use-wildcard leaves out.\n'
    )


def test_write(ros2, tmp_path):
    good, bad = tmp_path / 'good.yaml', tmp_path / 'bad.yaml'
    good.write_text(DUMP.replace('speed: 5', 'speed: 9').replace('p: 1.5', 'p: 2.5'))
    bad.write_text('nothing: {of: the kind}')
    changed, value, loaded, after, out_of_range, kind, wrong_file, no_file = ros2(
        'param set /lamp speed 7',
        'param get /lamp speed',
        f'param load /lamp {good}',
        'param get /lamp pid.p',
        'param set /lamp speed 70',
        'param set /lamp speed fast',
        f'param load /lamp {bad}',
        'param load /lamp nowhere.yaml',
    )
    assert changed.out == 'Set parameter successful\n'
    assert value.out == 'Integer value is: 7\n'
    assert 'Set parameter pid.p successful' in loaded.lines
    assert after.out == 'Double value is: 2.5\n'
    assert out_of_range.err.startswith('Setting parameter failed: Parameter speed out of range')
    assert kind.err.startswith('Setting parameter failed: Wrong parameter type')
    assert wrong_file.err == (
        "Param file does not contain parameters for /lamp, only for nodes: ['nothing']\n"
    )
    assert no_file.err == 'nowhere.yaml can not be read: No such file or directory\n'
    assert {answer.code for answer in (out_of_range, kind, wrong_file, no_file)} == {1}


@pytest.mark.slow('starts other processes')
def test_wrong_names(ros2):
    node, name, described, hidden = ros2(
        'param list /lump',
        'param get /lamp sped',
        'param describe /lamp spee',
        'param get /nobody x',
    )
    assert node.err == "Node not found\nDid you mean '/lamp'?\n"
    assert name.err == (
        "Parameter not set: /lamp has no parameter 'sped'.\nDid you mean 'speed'?\n"
    )
    assert described.err == "/lamp has no parameter 'spee'.\nDid you mean 'speed'?\n"
    assert hidden.code == 1 and hidden.err.startswith('Node not found\n')
