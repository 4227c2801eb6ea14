"""A friend in a domain that is shared: a program as there is one on any computer with ROS 2.

It knows nothing of labkit's own: a node with a name, in the domain of the variables. It answers
what others say on `/shared_chatter`, and says on demand what it sees of them.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from labkit.programs.child_processes import Process
    from labkit.sharing.joining import Joined

__all__ = ['start_friend']

TOPIC = 'shared_chatter'
NAME = 'Bo'
QUESTION = 'What do you see'
MEET_SEC, GONE_SEC = 25.0, 5.0
LOOK_SEC = 0.05

_process: Process | None = None


def start_friend(room: Joined) -> None:
    """Start the friend as a process in the domain of a room, and wait until you hear each other.

    One that is there already is ended first. `lab.processes()` lists and stops it, and it ends
    when the room is left.

    Args:
        room: What `lab.join` has returned.

    Raises:
        LabTimeout: He did not come.
    """
    global _process
    from labkit.background.runtime import runtime
    from labkit.programs.child_processes import environment, start_process

    if _process is not None:
        _process.stop()
        runtime.wait(lambda: f'/{NAME.lower()}' not in room.others, GONE_SEC)
    variables = {
        **environment(),
        'ROS_DOMAIN_ID': str(room.domain_id),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
    }
    command = [sys.executable, '-c', f'from {__name__} import main; main()']
    _process = start_process('friend', command, variables)
    room.programs.append(_process)
    room.wait_for_others(1, timeout_sec=MEET_SEC)
    print(f'{NAME} is there.')


def main() -> None:
    """Be the friend until interrupted."""
    import rclpy
    from rclpy.node import Node
    from std_msgs.msg import String

    from labkit.programs.program import publish_when_heard, spin_until_interrupted

    rclpy.init()
    node = Node(NAME.lower(), start_parameter_services=False, enable_rosout=False)
    publisher = node.create_publisher(String, TOPIC, 10)
    looking: list[Any] = []

    def say(text: str) -> None:
        # Bo hears himself, too.
        publish_when_heard(publisher, String(data=f'{NAME}: {text}'), 2, MEET_SEC)

    def answer(msg: Any) -> None:
        who, _, text = msg.data.partition(': ')
        if who == NAME:
            return
        if QUESTION in text:
            looking.append(node.create_timer(LOOK_SEC, look))
        else:
            say(f'I hear you, {who}')

    def look() -> None:
        # The name of a node comes a moment later than what it has to say.
        ends = node.get_publishers_info_by_topic(TOPIC)
        if len(ends) > 1 and all(end.node_name in node.get_node_names() for end in ends):
            node.destroy_timer(looking.pop())
            say(_seen(node))

    node.create_subscription(String, TOPIC, answer, 10)
    spin_until_interrupted(node)


def _seen(node: Any) -> str:
    """Say which nodes and topics there are, without what each node has."""
    nodes = sorted(node.get_node_names())
    topics = sorted(
        name for name, _ in node.get_topic_names_and_types() if name != '/parameter_events'
    )
    return f'the nodes {", ".join(nodes)} and the topics {", ".join(topics)}'
