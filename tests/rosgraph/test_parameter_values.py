"""Parameters as data: values from text, files of parameters."""

from __future__ import annotations

from pathlib import Path

import pytest
import rclpy
from rclpy.node import Node

from labkit.errors import LabError
from labkit.rosgraph.parameter_files import flat, is_meant, sections_in
from labkit.rosgraph.parameter_values import (
    parameters_in,
    python_value,
    to_yaml,
    type_word,
    value_from,
)
from labkit.rosgraph.yaml_loading import load_yaml


@pytest.mark.parametrize(
    ('text', 'value', 'kind'),
    [
        ('5', 5, 'integer'),
        ('5.0', 5.0, 'double'),
        ('true', True, 'boolean'),
        ('fast', 'fast', 'string'),
        ('[1, 2]', [1, 2], 'integer array'),
        ('[a, b]', ['a', 'b'], 'string array'),
        # What can not be read as YAML is a text.
        ('{', '{', 'string'),
        ('&a [*a]', '&a [*a]', 'string'),
    ],
)
def test_a_value_has_the_type_that_its_text_looks_like(text, value, kind):
    found = value_from(text)
    assert type_word(found.type) == kind
    assert (
        list(python_value(found)) == value if kind.endswith('y') else python_value(found) == value
    )


def test_what_is_dumped_can_be_loaded(tmp_path):
    values = {'pid.p': value_from('1.5'), 'pid.i': value_from('0.1'), 'name': value_from('a')}
    path = tmp_path / 'lamp.yaml'
    path.write_text(to_yaml('/lamp', values))
    found = parameters_in(str(path), '/lamp')
    assert {name: parameter.value for name, parameter in found.items()} == values


def test_a_parameter_may_have_the_name_of_a_group(tmp_path):
    names = ['b', 'b.size', 'b.size.x', 'pid.p', 'pid.p.max', 'pid.i']
    for order in (names, names[::-1]):
        values = {name: value_from(str(number)) for number, name in enumerate(order)}
        path = tmp_path / 'lamp.yaml'
        path.write_text(to_yaml('/lamp', values))
        found = parameters_in(str(path), '/lamp')
        assert {name: parameter.value for name, parameter in found.items()} == values
        rclpy.init(args=['--ros-args', '--params-file', str(path)])
        try:
            node = Node('lamp', automatically_declare_parameters_from_overrides=True)
            assert [node.get_parameter(name).value for name in order] == list(range(6))
            node.destroy_node()
        finally:
            rclpy.shutdown()


def test_what_is_for_every_node_comes_first(tmp_path):
    path = tmp_path / 'all.yaml'
    path.write_text(
        '/lamp: {ros__parameters: {speed: 2}}\n/**: {ros__parameters: {speed: 1, name: a}}\n'
    )
    both = parameters_in(str(path), '/lamp')
    assert (both['speed'].value.integer_value, both['name'].value.string_value) == (2, 'a')
    assert set(parameters_in(str(path), '/lamp', wildcard=False)) == {'speed'}
    assert set(parameters_in(str(path), '/talker')) == {'speed', 'name'}
    with pytest.raises(LabError, match='does not contain parameters for /talker'):
        parameters_in(str(path), '/talker', wildcard=False)


@pytest.mark.parametrize(
    ('key', 'node'),
    [
        ('lamp', '/lamp'),
        ('hall/lamp', '/hall/lamp'),
        ('/**/lamp', '/hall/lamp'),
        ('/**/lamp', '/lamp'),
        ('/*/lamp', '/hall/lamp'),
        ('/hall/**', '/hall/lamp'),
    ],
)
def test_names_of_nodes_in_a_file(tmp_path, key, node):
    path = tmp_path / 'all.yaml'
    path.write_text(f'{key}: {{ros__parameters: {{speed: 2}}}}')
    assert parameters_in(str(path), node)['speed'].value.integer_value == 2
    with pytest.raises(LabError, match='only for nodes'):
        parameters_in(str(path), node, wildcard=False) if '*' in key else parameters_in(
            str(path), '/tower/lamp/shade'
        )


def test_namespaces_in_a_file_may_be_groups(tmp_path):
    path = tmp_path / 'all.yaml'
    path.write_text('hall: {lamp: {ros__parameters: {speed: 2}}}\nlamp: {ros__parameters: {a: 1}}')
    assert set(parameters_in(str(path), '/hall/lamp')) == {'speed'}
    assert set(parameters_in(str(path), '/lamp')) == {'a'}


def test_the_nearest_name_in_a_file_is_told(tmp_path):
    path = tmp_path / 'all.yaml'
    path.write_text('cruizer: {ros__parameters: {speed: 2}}')
    with pytest.raises(LabError, match="Did you mean '/cruizer'"):
        parameters_in(str(path), '/cruiser')


@pytest.mark.parametrize(
    ('text', 'sentence'),
    [
        ('', 'Param file does not contain selected parameters'),
        ('- a', 'is no file of parameters'),
        ('hello', 'is no file of parameters'),
        ('{', 'is no file of parameters'),
        ('/lamp: {ros__parameters: 5}', 'is no file of parameters'),
        (
            f'/lamp: {{ros__parameters: {{speed: {"9" * 400}}}}}',
            r'no file of parameters: speed can not be 9+ \.\.\. 9+\. .* must be an integer in',
        ),
        ('/lamp: {speed: 5}', 'YAML file is not a valid ROS parameter file for node /lamp'),
    ],
)
def test_what_is_no_file_of_parameters(tmp_path, text, sentence):
    path = tmp_path / 'lamp.yaml'
    path.write_text(text)
    with pytest.raises(LabError, match=sentence):
        parameters_in(str(path), '/lamp')
    with pytest.raises(LabError, match='can not be read'):
        parameters_in(str(tmp_path), '/lamp')


@pytest.mark.parametrize(
    'text',
    [
        'cruiser: {ros__parameters: {a: 1}}',
        '/cruiser: {ros__parameters: {a: 1}}',
        'robot1: {cruiser: {ros__parameters: {a: 1, b: {c: 2}}}}',
        'robot1/cruiser: {ros__parameters: {a: 1}}',
        'robot1: {cruiser: {ros__parameters: {a: 1}}, other: {}}',
        'robot1: {"**": {ros__parameters: {a: 1}}}',
        '"**": {cruiser: {ros__parameters: {a: 1}}}',
        '/**: {ros__parameters: {a: 1}}',
        '/**/cruiser: {ros__parameters: {a: 1}}',
        '/*/cruiser: {ros__parameters: {a: 1}}',
        '/*: {ros__parameters: {a: 1}}',
        'cruiser2: {ros__parameters: {a: 1}}',
    ],
)
def test_a_file_means_the_same_nodes_as_to_ros_itself(text: str, tmp_path: Path) -> None:
    path = tmp_path / 'file.yaml'
    path.write_text(text)
    context = rclpy.Context()
    rclpy.init(args=['--ros-args', '--params-file', str(path)], context=context)
    for name, namespace in (('cruiser', ''), ('cruiser', '/robot1'), ('cruiser', '/a/b')):
        node = Node(name, namespace=namespace, context=context, start_parameter_services=False)
        given = {key: each.value for key, each in node._parameter_overrides.items()}
        node.destroy_node()
        ours = {
            key: value
            for meant, values in sections_in(load_yaml(text))
            if values is not None and is_meant(meant, f'{namespace}/{name}')
            for key, value in flat(values)
        }
        assert ours == given
    rclpy.shutdown(context=context)
