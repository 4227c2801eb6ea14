"""A node as the last value of a cell."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.conftest import Kernel

STAGE = """
import labkit as lab
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16, String
from std_srvs.srv import SetBool

lab.start()

class Talker(Node):
    def __init__(self, name='talker'):
        super().__init__(name)
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_subscription(Int16, 'odds', print, 10)
        self.create_service(SetBool, 'lamp', lambda request, response: response)
        self.create_client(SetBool, 'door')
"""
CARD = """NODE: /talker
  It runs in the background.
  Publishes:  /chatter [std_msgs/msg/String]
  Subscribes: /odds [std_msgs/msg/Int16]
  Serves:     /lamp [std_srvs/srv/SetBool]
  Calls:      /door [std_srvs/srv/SetBool]"""


def shown(kernel: Kernel, code: str) -> dict[str, str]:
    result = kernel.run(code)
    assert not result.error, result.traceback
    data: dict[str, str] = result.outputs[-1]['data'] if result.outputs else {}
    return data


@pytest.fixture
def show(start_kernel: Callable[..., Kernel]) -> Callable[[str], dict[str, str]]:
    """Give a function that runs a cell and returns its last value, in all its forms."""
    kernel = start_kernel()
    shown(kernel, STAGE)
    return lambda code: shown(kernel, code)


def test_node_shows_its_name_topics_and_services(show: Callable[[str], dict[str, str]]) -> None:
    data = show('lab.spin(Talker())')
    assert data['text/plain'] == CARD
    assert '/chatter [std_msgs/msg/String]' in data['text/html']


def test_node_that_is_not_spun_or_has_ended_says_so(
    show: Callable[[str], dict[str, str]],
) -> None:
    data = show("node = Node('idle')\nnode")
    assert data['text/plain'] == 'NODE: /idle\n  It is not spun: `lab.spin(node)` runs it.'
    data = show('lab.remove(node)\nnode')
    assert data['text/plain'] == 'NODE: Node\n  It has ended.'
    data = show('class Half(Node):\n    def __init__(self):\n        pass\nHalf()')
    said = 'It is not a node yet: its __init__ has not called the one of Node.'
    assert data['text/plain'] == f'NODE: Half\n  {said}'


def test_other_forms_stay(show: Callable[[str], dict[str, str]]) -> None:
    show("""
class Own(Node):
    def __repr__(self):
        return 'my own words'

    def _repr_html_(self):
        return '<b>my own</b>'
""")
    data = show("lab.spin(Own('own'))")
    assert (data['text/plain'], data['text/html']) == ('my own words', '<b>my own</b>')
    assert 'NODE' not in show('[node for node in [lab.spin(Talker())]]')['text/plain']


def test_without_the_notebook_functions_a_node_is_shown_as_python_does(
    show: Callable[[str], dict[str, str]],
) -> None:
    data = show("""
from labkit.background import notebook_rclpy
node = lab.spin(Talker())
notebook_rclpy.uninstall()
node
""")
    assert data['text/plain'].startswith('<__main__.Talker object at ')
    assert set(data) == {'text/plain'}
