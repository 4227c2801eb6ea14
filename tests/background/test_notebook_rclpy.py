"""The functions that stand in for those of rclpy: same parameters, and they go back."""

from __future__ import annotations

import inspect

import pytest

from labkit.background.notebook_rclpy import ORIGINALS, REPLACED, _NotebookSafe


@pytest.mark.parametrize('name', [safe for _, _, safe in REPLACED])
def test_parameters_are_those_of_the_original(name: str) -> None:
    original = inspect.signature(ORIGINALS[name]).parameters
    safe = dict(inspect.signature(getattr(_NotebookSafe, name)).parameters)
    del safe['self']
    if '.' in ORIGINALS[name].__qualname__:
        # A method: the object itself comes first, under a name that says what it is.
        safe.pop(next(iter(safe)))
        original = {key: value for key, value in original.items() if key != 'self'}
    rest = {key for key, value in safe.items() if value.kind in (value.VAR_POSITIONAL,)}
    passes_on = bool(rest)
    named = {
        key: value
        for key, value in safe.items()
        if value.kind not in (value.VAR_POSITIONAL, value.VAR_KEYWORD)
    }
    for key, value in named.items():
        assert key in original, f'{name} has no parameter {key}'
        assert (value.kind, value.default) == (original[key].kind, original[key].default), key
    # What is not named has to be passed on, and what is named has to come first.
    assert list(named) == list(original)[: len(named)]
    assert passes_on or len(named) == len(original)


def test_originals_come_back(kernel):
    kernel.run('import rclpy, rclpy.client, rclpy.executors, rclpy.node\nbefore = rclpy.init')
    code = """
import labkit as lab
from labkit.background import notebook_rclpy
def replaced():
    return [getattr(getattr(owner, name), '_labkit', False)
            for owner, name, _ in notebook_rclpy.REPLACED]
print(replaced())
lab.start()
print(replaced())
notebook_rclpy.uninstall()
print(replaced(), rclpy.init is before)
lab.stop()
lab.start()
print(replaced())
"""
    assert kernel.run(code).text.splitlines() == [
        str([False] * 10),
        str([True] * 10),
        f'{[False] * 10} True',
        str([True] * 10),
    ]


def test_what_somebody_else_has_replaced_since_stays(kernel):
    code = """
import labkit as lab, rclpy
from labkit.background import notebook_rclpy
lab.start()
mine = rclpy.spin = lambda node: None
notebook_rclpy.uninstall()
print(rclpy.spin is mine)
"""
    assert kernel.run(code).text == 'True\n'


def test_the_newest_official_example_is_explained(kernel):
    kernel.run('import labkit as lab\nlab.start()\nimport rclpy')
    result = kernel.run(
        'def main(args=None):\n    with rclpy.init(args=args):\n        pass\nmain()'
    )
    assert result.error.startswith(('TypeError', 'AttributeError'))
    assert 'with rclpy.init(args=args):' in result.traceback
    assert 'written for a newer release of ROS 2' in result.traceback
    assert 'rclpy.shutdown()' in result.traceback
    # Another mistake with `with` is another matter.
    other = kernel.run('with None:\n    pass')
    assert 'newer release' not in other.traceback


HEAP = """
import gc, time
import labkit as lab
from rclpy.node import Node
lab.start()
looked = []
get_objects = gc.get_objects
gc.get_objects = lambda *args: looked.append(1) or get_objects(*args)
for number in range(20):
    node = lab.spin(Node(f'node_{number % 5}'))
lab.doctor()
print(len(looked))
from labkit.background.nodes import existing_nodes
print(sorted(n.get_name() for n in existing_nodes() if not n.get_name().startswith('_')))
"""


def test_a_new_node_does_not_look_through_the_heap(kernel):
    result = kernel.run(HEAP)
    names = [f'node_{number}' for number in range(5)]
    assert (result.error, result.text) == ('', f'0\n{names}\n')


def test_nodes_made_before_labkit_are_known(kernel):
    kernel.run(
        'import rclpy\nfrom rclpy.context import Context\nfrom rclpy.node import Node\n'
        'context = Context()\nrclpy.init(context=context)\nearly = Node("early", context=context)'
    )
    result = kernel.run(
        'import labkit as lab\nlab.start()\n'
        'from labkit.background.nodes import existing_nodes\n'
        'print(early in existing_nodes())\nearly.destroy_node()\nrclpy.shutdown(context=context)'
    )
    assert (result.error, result.text) == ('', 'True\n')
