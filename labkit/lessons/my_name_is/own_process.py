"""Exercise: the first stage as a program of its own."""

from __future__ import annotations

from labkit.exercises import (
    Exercise,
    Fail,
    NotAttempted,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons.my_name_is.two_stages import OPENING, STRING

__all__ = ['own_process']

_SCRIPT = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Opener(Node):
    def __init__(self):
        super().__init__('opener')
        self.publisher = self.create_publisher(String, 'incomplete', 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='My name is '))


rclpy.init()
rclpy.spin(Opener())
"""

_START = f'''
import subprocess
import sys

from std_msgs.msg import String

earlier = globals().get('process')
if earlier is not None:
    earlier.terminate()

program = """{_SCRIPT}"""

process = subprocess.Popen([sys.executable, '-c', program])
print(lab.wait_for_message('/incomplete', String, timeout_sec=20))
'''


def _judge_own_process(probe: Probe) -> str:
    try:
        one = expect.publisher(probe, '/incomplete')
    except NotAttempted:
        _refuse_ended_process()
        raise
    expect.that(
        not probe.in_this_process(one),
        expected='/incomplete with a publisher in a process of its own',
        seen=str(one),
        why='lab.spin() runs a node in the process of this notebook.',
        todo='End it with lab.remove(...), and start a program with subprocess.Popen(...).',
    )
    texts = expect.messages(probe, one, count=2, hz=2.0)
    expect.equal(texts, 'data', OPENING, todo=f'Publish {OPENING!r}, with a space at the end.')
    done = f'{one.node} runs in a process of its own.'
    if {endpoint.msg_type for endpoint in probe.publishers('/complete')} != {STRING}:
        return done
    complete = probe.watch('/complete', STRING)
    if probe.wait(lambda: len(complete), 1.0):
        text = complete.values('data')[0]
        return f'{done}\nThe stage in this notebook has noticed nothing, and says {text!r}.'
    return done


def _refuse_ended_process() -> None:
    """Raise Fail if a process that this notebook has started is over already."""
    import psutil  # type: ignore[import-untyped]

    children = psutil.Process().children()
    if any(child.status() == psutil.STATUS_ZOMBIE for child in children):
        raise Fail(
            'a process that publishes on /incomplete',
            'a process that this notebook has started, and that is over',
            why='A program ends when its last line is done or when an error comes up. '
            'rclpy.spin(node) in the last line keeps it going.',
            todo='See what it says: print(subprocess.run([sys.executable, "-c", program], '
            'capture_output=True, text=True).stderr)',
        )


own_process = Exercise(
    name='own_process',
    task=f'Publish {OPENING!r} on /incomplete, twice a second, from a process of its own.',
    publishes={'/incomplete': STRING},
    judge=_judge_own_process,
    hints=[
        'The class of stage one stays as it is. What does a program need besides the class?',
        'Imports at the top; at the end rclpy.init() and rclpy.spin(...). lab is not needed '
        'there.',
        'Put all of it between the quotation marks, and remove the # from the last lines.',
    ],
    answer=Solution(
        _START,
        'rclpy.init() starts ROS in the new process, and rclpy.spin() keeps it going. Stage two '
        'knows the topic only, so it does not matter to it in which process stage one runs. '
        'Before another process is started, the earlier one is ended: otherwise both would '
        'publish.',
    ),
    styles=[
        Style('a script, started by hand', _SCRIPT, process=True),
        Style(
            'a loop',
            """
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('somebody')
publisher = node.create_publisher(String, '/incomplete', 1)
while rclpy.ok():
    publisher.publish(String(data='My name is '))
    time.sleep(0.5)
""",
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'in the notebook',
            changed(
                _SCRIPT,
                ('rclpy.init()\nrclpy.spin(Opener())', 'lab.spin(Opener())'),
            ),
            'lab.spin() runs a node in the process of this notebook.',
        ),
        Wrong(
            'does not spin',
            f'''
import subprocess
import sys
from pathlib import Path

program = """{changed(_SCRIPT, ('rclpy.spin(Opener())', 'Opener()'))}"""
process = subprocess.Popen([sys.executable, '-c', program])
status = Path(f'/proc/{{process.pid}}/status')
lab.wait_until(lambda: 'zombie' in status.read_text(), timeout_sec=20)
''',
            'rclpy.spin(node) in the last line keeps it going',
        ),
        Wrong(
            'space missing',
            changed(_SCRIPT, ("'My name is '", "'My name is'")),
            'A space is missing at the end of the text.',
            process=True,
        ),
        Wrong(
            'two copies running',
            changed(_SCRIPT, ('rclpy.spin(', 'copy = Opener()\nrclpy.spin(')),
            'Two copies of the node run at once',
            process=True,
        ),
    ],
)
