"""Exercise: find the node that publishes the wrong type."""

from __future__ import annotations

from collections.abc import Collection

from labkit.exercises import Exercise, Fail, NotAttempted, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Clause, Evidence, Publishes
from labkit.exercises.expect import show
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.odds.stadium import GATES, VISITORS, wrong_gates

__all__ = ['find_gate']

STRING = 'std_msgs/msg/String'
TOPIC = '/wrong_gate'

_INSPECTOR = """
from rclpy.node import Node
from std_msgs.msg import String


class Inspector(Node):
    def __init__(self):
        super().__init__('inspector')
        self.publisher = self.create_publisher(String, 'wrong_gate', 10)
        self.timer = self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        for info in self.get_publishers_info_by_topic('/visitors'):
            if info.topic_type != 'std_msgs/msg/Int16':
                self.publisher.publish(String(data=info.node_name))


inspector = lab.spin(Inspector())
"""
_DIFFERS = "!= 'std_msgs/msg/Int16'"


class _NamesTheGate(Clause):
    """Each message is the name of the gate that differs from the others."""

    text = (
        'each message is the name of the wrong gate and nothing else; a slash in front of it does '
        'no harm'
    )

    def find(self, evidence: Evidence) -> None:
        """Look whether there is a gate to be found."""
        if not wrong_gates():
            raise NotAttempted('The stadium is closed. Run the cell with open_stadium() first.')

    def judge(self, evidence: Evidence) -> str:
        """Compare the names."""
        from labkit.rosgraph.names import UNKNOWN_NODE

        gates = wrong_gates()
        rights = {name for gate in gates for name in (gate, gate.lstrip('/'))}
        # What rmw says of a node that the inspector's own process has only half discovered.
        names = [n for n in evidence.streams[TOPIC, ''].values('data') if n != UNKNOWN_NODE]
        wrong = [name for name in names if name not in rights]
        if wrong:
            why, todo = _explain(evidence, wrong[0], rights.intersection(names))
            raise Fail(
                f'on {TOPIC} the name of the one gate whose type is not that of the others, and '
                'nothing else',
                f'data = {show(list(dict.fromkeys(names)))}',
                why=why,
                todo=todo,
            )
        return f'{gates[0]} publishes another type on {VISITORS}, and you found it.'


def _explain(evidence: Evidence, name: str, found: Collection[str]) -> tuple[str, str]:
    """Return what a wrong name shows, and the next step.

    Args:
        evidence: What was seen.
        name: The wrong name.
        found: The right names that came besides.
    """
    look = f"Look at topic_type in get_publishers_info_by_topic('{VISITORS}')."
    bare = name.strip().lstrip('/')
    gates = [gate.lstrip('/') for gate in GATES]
    if found and bare in gates:
        return 'Several gates are named. Only one of them has another type.', look
    if bare in gates and bare == name.lstrip('/'):
        return f'{name} publishes Int16, as most gates do.', look
    if bare in gates:
        return 'There is a space too many beside the name.', 'Use info.node_name as it is.'
    if bare.lower() in gates:
        return 'Capital and small letters differ in names.', 'Write the name as the graph does.'
    if '/msg/' in name:
        return 'That is a type. The name of the node is asked for.', 'Use info.node_name.'
    if bare in [topic.lstrip('/') for topic in evidence.probe.topics()]:
        return 'That is a topic. The name of the node is asked for.', 'Use info.node_name.'
    if not name:
        return 'The message was published as it was made: its field data is an empty text.', look
    if any(gate in name for gate in gates):
        return 'There is more in the text than the name.', 'Publish String(data=info.node_name).'
    return f'There is no gate called {name!r}.', look


find_gate = Exercise(
    name='find_gate',
    task=f'One gate publishes another type on {VISITORS}. Find it, and publish its name as a '
    f'`String` on {TOPIC}, at least once a second.',
    publishes={TOPIC: STRING},
    clauses=(Publishes(TOPIC, 1.0, STRING, at_least=True), _NamesTheGate()),
    hints=[
        f'Ask the graph who publishes on {VISITORS}, as the lesson did for /goals.',
        'Each entry of get_publishers_info_by_topic() has a node_name and a topic_type. Print '
        'both, and compare.',
        'Publish the name that you have found: String(data=...). Better: let a loop over the '
        'entries find the one whose topic_type is not std_msgs/msg/Int16.',
    ],
    answer=Solution(
        _INSPECTOR,
        'The graph knows the type of every publisher, so a node can look for the odd one by '
        'itself. On a robot such a node can run all the time.',
    ),
    styles=[
        Style(
            'functions, and the name typed in',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('reporter')
publisher = node.create_publisher(String, '/wrong_gate', 10)
types = {i.node_name: i.topic_type for i in node.get_publishers_info_by_topic('/visitors')}
(name,) = [n for n, t in types.items() if list(types.values()).count(t) == 1]
node.create_timer(0.2, lambda: publisher.publish(String(data='/' + name)))
lab.spin(node)
""",
        ),
        Style(
            'looked up once, in a thread that sleeps',
            """
import threading
import time

import rclpy
from std_msgs.msg import String

node = rclpy.create_node('referee_assistant')
publisher = node.create_publisher(String, '/wrong_gate', 1)
for info in node.get_publishers_info_by_topic('/visitors'):
    if 'Int16' not in info.topic_type:
        name = info.node_name


def work(publisher, name):
    while rclpy.ok():
        publisher.publish(String(data=name))
        time.sleep(0.7)


threading.Thread(target=work, args=[publisher, name], daemon=True).start()
""",
        ),
        Style(
            'kept for those who come late, once a second',
            changed(
                _INSPECTOR,
                (
                    "create_publisher(String, 'wrong_gate', 10)",
                    "create_publisher(\n            String, 'wrong_gate', "
                    'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n        )',
                ),
                (
                    'from rclpy.node import Node\n',
                    'from rclpy.node import Node\n'
                    'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
                ),
                ('create_timer(0.2,', 'create_timer(1,'),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_INSPECTOR))),
        Style(
            'own process',
            in_process(_INSPECTOR),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'names a gate that is in order',
            changed(
                _INSPECTOR,
                (_DIFFERS, _DIFFERS.replace('!', '=')),
                ('data=info.node_name))', 'data=info.node_name))\n                break'),
            ),
            'publishes Int16, as most gates do',
        ),
        Wrong(
            'names all gates',
            changed(_INSPECTOR, (_DIFFERS, "!= ''")),
            'Several gates are named.',
        ),
        Wrong(
            'names the type',
            changed(_INSPECTOR, ('info.node_name', 'info.topic_type')),
            'That is a type.',
        ),
        Wrong(
            'names the topic',
            changed(_INSPECTOR, ('info.node_name', "'visitors'")),
            'That is a topic.',
        ),
        Wrong(
            'capital letters',
            changed(_INSPECTOR, ('info.node_name', 'info.node_name.title()')),
            'Capital and small letters differ in names.',
        ),
        Wrong(
            'a number for a name',
            changed(_INSPECTOR, ('String', 'Int16'), ('info.node_name', '4')),
            'A topic carries one type of message.',
        ),
        Wrong(
            'compares with a short name',
            changed(_INSPECTOR, (_DIFFERS, "== 'Int32'")),
            'publish() is not called there',
        ),
        Wrong(
            'other topic',
            changed(_INSPECTOR, ("'wrong_gate'", "'WrongGate'")),
            'The names differ in an underscore',
        ),
        Wrong(
            'every 5 s',
            changed(_INSPECTOR, ('create_timer(0.2,', 'create_timer(5,')),
            'times too slow',
        ),
        Wrong(
            'ends after ten',
            changed(
                _INSPECTOR,
                (
                    "super().__init__('inspector')\n",
                    "super().__init__('inspector')\n        self.n = 0\n",
                ),
                (
                    '    def on_timer(self):\n',
                    '    def on_timer(self):\n        self.n += 1\n        if self.n > 10:\n'
                    '            return\n',
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'a name in a sentence',
            changed(_INSPECTOR, ('data=info.node_name', "data=f'It is {info.node_name}'")),
            'There is more in the text than the name.',
        ),
        Wrong(
            'the right gate first, then all of them',
            changed(
                _INSPECTOR,
                (
                    "super().__init__('inspector')\n",
                    "super().__init__('inspector')\n        self.n = 0\n",
                ),
                ('    def on_timer(self):\n', '    def on_timer(self):\n        self.n += 1\n'),
                (f'info.topic_type {_DIFFERS}:', f'self.n > 50 or info.topic_type {_DIFFERS}:'),
            ),
            'Several gates are named.',
        ),
        Wrong(
            'also the referee',
            changed(
                _INSPECTOR,
                (
                    "get_publishers_info_by_topic('/visitors'):",
                    "get_publishers_info_by_topic('/goals'):\n"
                    '            self.publisher.publish(String(data=info.node_name))\n'
                    "        for info in self.get_publishers_info_by_topic('/visitors'):",
                ),
            ),
            "There is no gate called 'referee'.",
        ),
        Wrong(
            'published once',
            changed(
                _INSPECTOR,
                ('self.timer = self.create_timer(0.2, self.on_timer)', 'self.on_timer()'),
            ),
            'The node has no timer',
        ),
        Wrong(
            'a number of the graph for its name',
            changed(_INSPECTOR, ('data=info.node_name', 'data=info.endpoint_type')),
            'takes values of type str',
            outcome=Outcome.ERROR,
        ),
    ],
)
