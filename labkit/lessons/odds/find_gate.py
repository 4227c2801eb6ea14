"""Exercise: find the node that publishes the wrong type."""

from __future__ import annotations

from labkit.exercises import (
    Exercise,
    NotAttempted,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons._script import in_process
from labkit.lessons.odds.stadium import GATES, VISITORS, wrong_gates

__all__ = ['find_gate']

STRING = 'std_msgs/msg/String'
TOPIC = '/wrong_gate'
# How long a publisher may be on its way from another process, or from a thread.
PROCESS_SEC = 2.0
THREAD_SEC = 0.2

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


def _judge_find_gate(probe: Probe) -> str:
    from labkit.rosgraph.names import UNKNOWN_NODE

    gates = wrong_gates()
    if not gates:
        raise NotAttempted('The stadium is closed. Run the cell with open_stadium() first.')
    # The stadium is a young process itself, so a matcher would wait long for a publisher.
    elsewhere = any(probe.node_object(name) is None for name in probe.node_names())
    if not probe.wait(probe.attempt, PROCESS_SEC if elsewhere else THREAD_SEC):
        raise NotAttempted(
            f'Not attempted yet. Nobody publishes on {TOPIC}. Write your code in the cell above, '
            'run that cell, then run this one again.'
        )
    source = expect.publisher(probe, TOPIC)
    watch = expect.messages(probe, source, count=2)
    probe.wait(lambda: False, 0.3)  # what else is said
    # What rmw says of a node that the inspector's own process has only half discovered.
    names = {str(name) for name in watch.values('data')} - {UNKNOWN_NODE}
    wrong = sorted(name for name in names if f'/{name.strip().lstrip("/")}' not in gates)
    if wrong:
        why, todo = _explain(probe, wrong[0], len(names))
        expect.that(
            False,
            expected=f'on {TOPIC} the name of the one gate whose type is not that of the others',
            seen=f'data = {expect.show(sorted(names))}',
            why=why,
            todo=todo,
        )
    return f'{gates[0]} publishes another type on {VISITORS}, and you found it.'


def _explain(probe: Probe, name: str, count: int) -> tuple[str, str]:
    look = f"Look at topic_type in get_publishers_info_by_topic('{VISITORS}')."
    if count > 1:
        return 'Several gates are named. Only one of them has another type.', look
    if f'/{name.strip().lstrip("/")}' in GATES:
        return f'{name} publishes Int16, as most gates do.', look
    if name.strip().lower().lstrip('/') in [gate.lstrip('/') for gate in GATES]:
        return 'Capital and small letters differ in names.', 'Write the name as the graph does.'
    if '/msg/' in name:
        return 'That is a type. The name of the node is asked for.', 'Use info.node_name.'
    if name.lstrip('/') in [topic.lstrip('/') for topic in probe.topics()]:
        return 'That is a topic. The name of the node is asked for.', 'Use info.node_name.'
    return f'There is no gate called {name!r}.', look


find_gate = Exercise(
    name='find_gate',
    task=f'One gate publishes another type on {VISITORS}. Find it, and publish its name as a '
    f'`String` on {TOPIC}, at least once a second.',
    publishes={TOPIC: STRING},
    judge=_judge_find_gate,
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
    ],
)
