"""Exercise: the first stage as a program of its own."""

from __future__ import annotations

from labkit.exercises import (
    Exercise,
    Fail,
    NotAttempted,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.exercises.clauses import Clause, Evidence, Publishes
from labkit.lessons._script import started_by_asyncio, started_by_subprocess
from labkit.lessons.my_name_is.programs import ended_program
from labkit.lessons.my_name_is.two_stages_clauses import STRING, says_opening

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

_BEFORE = 'from labkit.lessons.my_name_is.programs import start_program\n\n'
_DOCSTRING = '"""Say how a sentence begins, twice a second."""'
_START = f"""{_BEFORE}program = r'''
{_DOCSTRING}
{_SCRIPT}'''

process = start_program(program)
"""


class _InAnotherProcess(Clause):
    """The publisher is not in this notebook's process."""

    text = 'the publisher is in another process than this notebook'

    def find(self, evidence: Evidence) -> None:
        """Look where the publisher is."""
        try:
            one = evidence.publisher('/incomplete')
        except NotAttempted:
            _refuse_ended_program()
            raise
        expect.that(
            not evidence.probe.in_this_process(one),
            expected='/incomplete with a publisher in a process of its own',
            seen=f'{one.node} {evidence.probe.place(one)}',
            why='lab.spin() runs a node in the process of this notebook.',
            todo='End it with lab.remove(...), and start a program with start_program(program).',
        )

    def judge(self, evidence: Evidence) -> str:
        """Say where it is."""
        one = evidence.publisher('/incomplete')
        return f'{one.node} runs {evidence.probe.place(one)}.'


def _refuse_ended_program() -> None:
    """Raise Fail if the program that this notebook has started last is over."""
    program = ended_program()
    if program is None:
        return
    last = program.output[-1] if program.output else 'nothing'
    raise Fail(
        'a program that goes on, and publishes on /incomplete',
        f'a program that has ended, with exit code {program.exit_code}; its last line is: {last}',
        why='An error has ended it. Its last line says which.'
        if program.exit_code
        else 'A program ends when its last line is done. rclpy.spin(node) in the last line keeps '
        'it going.',
        todo='Change the program, and run its cell again. That cell shows all that it says.',
    )


own_process = Exercise(
    name='own_process',
    task="Publish 'My name is ' on /incomplete, twice a second, from a process of its own.",
    publishes={'/incomplete': STRING},
    clauses=(_InAnotherProcess(), Publishes('/incomplete', 2.0, STRING), says_opening()),
    hints=[
        'The class of stage one stays as it is. What does a program need besides the class?',
        'Imports at the top; at the end rclpy.init() and rclpy.spin(...). lab is not needed '
        'there.',
        'Put all of it between the quotation marks, and remove the # from the last line.',
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
        Style(
            'a fast timer, and every fifth call counts',
            changed(
                _SCRIPT,
                (
                    "super().__init__('opener')\n",
                    "super().__init__('thermometer')\n        self.n = 0\n",
                ),
                ('create_timer(0.5,', 'create_timer(0.1,'),
                (
                    "        self.publisher.publish(String(data='My name is '))\n",
                    '        self.n += 1\n        if self.n % 5 == 0:\n'
                    "            self.publisher.publish(String(data='My name is '))\n",
                ),
            ),
            process=True,
        ),
        Style(
            'an executor with many threads',
            changed(
                _SCRIPT,
                ('rclpy.spin(Opener())', 'rclpy.spin(Opener(), executor=MultiThreadedExecutor())'),
                (
                    'from rclpy.node',
                    'from rclpy.executors import MultiThreadedExecutor\nfrom rclpy.node',
                ),
            ),
            process=True,
        ),
        Style(
            'a clock in seconds, asked often',
            """
import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('clock_watcher')
publisher = node.create_publisher(String, '/incomplete', 1)
due = node.get_clock().now()


def look():
    global due
    if node.get_clock().now() >= due:
        due = node.get_clock().now() + Duration(seconds=0.5)
        publisher.publish(String(data='My name is '))


node.create_timer(0.1, look)
rclpy.spin(node)
""",
            process=True,
        ),
        Style('started by subprocess', started_by_subprocess(_SCRIPT)),
        Style('started by asyncio', started_by_asyncio(_SCRIPT)),
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
            changed(_START, ('rclpy.spin(Opener())', 'Opener()')),
            'rclpy.spin(node) in the last line keeps it going',
        ),
        Wrong(
            'does not spin, started by subprocess',
            started_by_subprocess(changed(_SCRIPT, ('rclpy.spin(Opener())', 'Opener()')))
            + 'process.wait()\n',
            'rclpy.spin(node) in the last line keeps it going',
        ),
        Wrong(
            'an import is missing',
            changed(_START, ('from rclpy.node import Node\n', '')),
            "its last line is: NameError: name 'Node' is not defined",
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
        Wrong(
            'three times in two seconds',
            changed(_SCRIPT, ('create_timer(0.5,', 'create_timer(0.6,')),
            'times too slow',
            process=True,
        ),
        Wrong(
            'every 2 s',
            changed(_SCRIPT, ('create_timer(0.5,', 'create_timer(2,')),
            'A rate in Hz and a period in seconds were mixed up',
            process=True,
        ),
        Wrong(
            'ends after fifty',
            changed(
                _SCRIPT,
                (
                    "super().__init__('opener')\n",
                    "super().__init__('opener')\n        self.n = 0\n",
                ),
                (
                    "        self.publisher.publish(String(data='My name is '))\n",
                    '        self.n += 1\n        if self.n < 50:\n'
                    "            self.publisher.publish(String(data='My name is '))\n",
                ),
            ),
            'They stop coming.',
            process=True,
        ),
        Wrong(
            'twice each time',
            changed(
                _SCRIPT,
                (
                    "        self.publisher.publish(String(data='My name is '))\n",
                    "        self.publisher.publish(String(data='My name is '))\n" * 2,
                ),
            ),
            'Twice as many messages come as were asked for',
            process=True,
        ),
        Wrong(
            'another callback',
            changed(_SCRIPT, ('create_timer(0.5, self.on_timer)', 'create_timer(0.5, print)')),
            'publish() was called too early, once, or never',
            process=True,
        ),
    ],
)
