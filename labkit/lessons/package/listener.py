"""Exercise: a package made by hand, with a node that hears."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import partial

from labkit.exercises import Exercise, Fail, Outcome, Probe, Solution, Style, Wrong, changed
from labkit.lessons.package.content import Built, Does, Runs, Work, judge_package

__all__ = ['listener']

PACKAGE, PROGRAM, TOPIC = 'ears_lab', 'listener', '/chatter'
STRING = 'std_msgs/msg/String'

_LISTENER = '''
import shutil
from pathlib import Path

LISTENER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.subscription = self.create_subscription(String, 'chatter', self.on_chatter, 10)

    def on_chatter(self, msg):
        self.get_logger().info(f'I heard: {msg.data}')


def main():
    rclpy.init()
    node = Listener()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
"""

shutil.rmtree('src/ears_lab', ignore_errors=True)
%ros2 pkg create ears_lab --build-type ament_python --destination-directory src \\
    --node-name listener --dependencies rclpy std_msgs
Path('src/ears_lab/ears_lab/listener.py').write_text(LISTENER)
!colcon build --packages-select ears_lab
'''
_BUILD = '!colcon build --packages-select ears_lab\n'
_WRITE = "Path('src/ears_lab/ears_lab/listener.py').write_text(LISTENER)\n"
_ENTRY = """setup = Path('src/ears_lab/setup.py')
entry = "'console_scripts': ['listener = ears_lab.hearing:main'"
text = setup.read_text().replace("'console_scripts': [", entry)
setup.write_text(text)
"""
_EXPORTED = """
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.create_subscription(String, 'chatter', self.on_chatter, 10)

    def on_chatter(self, msg):
        self.get_logger().info(f'I heard: {msg.data}')


lab.export(Listener, package='ears_lab', folder='src', overwrite=True)
!colcon build --packages-select ears_lab
"""


def _needs(work: Work) -> None:
    import xml.etree.ElementTree as ET

    root = ET.parse(work.source / 'package.xml').getroot()
    tags = ('depend', 'exec_depend', 'build_depend')
    named = [each.text for tag in tags for each in root.findall(tag)]
    missing = [name for name in ('rclpy', 'std_msgs') if name not in named]
    if missing:
        raise Fail(
            'rclpy and std_msgs in package.xml',
            f'without {" and ".join(missing)}',
            why='It builds here, because this machine has them. On another machine nobody would '
            'know what to install.',
            todo=f'<depend>{missing[0]}</depend>, or --dependencies when the package is made.',
        )


def _logs(work: Work) -> None:
    """Send texts, and look for them in the log."""
    probe = work.probe
    ends = [end for end in probe.subscriptions(TOPIC) if end.node == '/listener']
    if not ends:
        topics = [end.topic for end in probe.all_subscriptions() if end.node == '/listener']
        raise Fail(
            f'a subscription of /listener to {TOPIC}',
            f'it subscribes to: {", ".join(topics)}' if topics else 'it subscribes to no topic',
            why='Names must be equal to the last letter.',
            todo="create_subscription(String, 'chatter', ...)",
        )
    if ends[0].msg_type != STRING:
        raise Fail(
            f'messages of type {STRING} on {TOPIC}',
            ends[0].msg_type,
            why='A topic carries one type: it would hear nobody who sends texts.',
            todo='Subscribe with String.',
        )
    numbers = random.sample(range(100_000, 1_000_000), k=12)
    words = [f'{random.choice(("red", "green", "blue"))} {number}' for number in numbers]
    send = probe.sender(TOPIC, STRING)

    def lines(word: str) -> int:
        return sum(word in log.msg for log in probe.logs if log.name == 'listener')

    for word in words:
        send({'data': word})
        # One after the other: a queue of any depth is enough.
        if not work.wait(partial(lines, word)):
            raise Fail(
                f'a line of the log for each text, such as: I heard: {word}',
                f'lines of the log: {[log.msg for log in probe.logs if log.name == "listener"]}',
                why='The callback does not log, or it logs something else. What print() writes is '
                'not in the log.',
                todo="self.get_logger().info(f'I heard: {msg.data}')",
            )
    # A second line of the last one may be on its way.
    often = {word: lines(word) for word in words[:-1]}
    twice = [word for word, count in often.items() if count > 1]
    if twice:
        raise Fail(
            'one line of the log for each text',
            f'{often[twice[0]]} lines with {twice[0]}',
            why='Somebody who counts the lines would count that text more than once.',
            todo='One subscription, and one call of info() in its callback.',
        )


CLAUSES: Sequence[Built | Runs | Does] = [
    Built(PACKAGE),
    Does('its package.xml names `rclpy` and `std_msgs` as dependencies', _needs),
    Runs(PROGRAM, 'listener', PACKAGE),
    Does('the node logs each text that comes on `/chatter` (`std_msgs/msg/String`), once', _logs),
]


def _judge(probe: Probe) -> str:
    return judge_package(probe, CLAUSES, PACKAGE)


listener = Exercise(
    name='listener',
    task='Make the package ears_lab with a listener, and build it.',
    clauses=CLAUSES,
    judge=_judge,
    hints=[
        'ros2 pkg create with --node-name listener makes the module and its entry in setup.py.',
        '--dependencies rclpy std_msgs goes into package.xml. Give --build-type ament_python, '
        'and --destination-directory src.',
        'Then put your own listener into src/ears_lab/ears_lab/listener.py, with main(), and run '
        '!colcon build --packages-select ears_lab',
    ],
    answer=Solution(
        _LISTENER,
        'The command makes the files, with an entry for listener. The module is replaced by one '
        'with a node, and main() spins it until it is interrupted.',
    ),
    styles=[
        Style('lab.export', _EXPORTED),
        Style('the whole workspace', changed(_LISTENER, (_BUILD, '!colcon build\n'))),
        Style(
            'links instead of copies',
            changed(
                _LISTENER, (_BUILD, _BUILD.replace('ears_lab\n', 'ears_lab --symlink-install\n'))
            ),
        ),
        Style(
            'an entry by hand, and another name of the module',
            changed(
                _LISTENER,
                ('    --node-name listener --dep', '    --dep'),
                ('ears_lab/listener.py', 'ears_lab/hearing.py'),
                (_BUILD, _ENTRY + _BUILD),
            ),
        ),
    ],
    wrong=[
        Wrong(
            'not built', changed(_LISTENER, (_BUILD, '')), 'colcon build has not been run since'
        ),
        Wrong(
            'built too early',
            changed(_LISTENER, (_WRITE + _BUILD, _BUILD + _WRITE)),
            'files in src that are newer than the last build that went well',
        ),
        Wrong(
            'beside src',
            changed(_LISTENER, (' --destination-directory src', ''), ('src/ears_lab', 'ears_lab')),
            'Packages lie in the folder src of a workspace.',
        ),
        Wrong(
            'another name',
            _LISTENER.replace('ears_lab', 'ear_lab'),
            'The name is close, and it is another one.',
        ),
        Wrong(
            'no dependencies',
            changed(_LISTENER, (' --dependencies rclpy std_msgs', '')),
            'without rclpy and std_msgs',
        ),
        Wrong(
            'no entry',
            changed(_LISTENER, ('    --node-name listener --dep', '    --dep')),
            'A module alone can not be run',
        ),
        Wrong(
            'another function',
            changed(_LISTENER, ('def main()', 'def run()')),
            'The entry in setup.py names a function that the module does not have.',
        ),
        Wrong(
            'does not spin',
            changed(_LISTENER, ('        rclpy.spin(node)', '        print(node)')),
            'main() returned at once',
        ),
        Wrong(
            'the name of the class',
            changed(_LISTENER, ("__init__('listener')", "__init__('Listener')")),
            'The name of the node is what super().__init__() gets.',
        ),
        Wrong(
            'another topic',
            changed(_LISTENER, ("'chatter'", "'chater'")),
            'it subscribes to: /chater',
        ),
        Wrong(
            'print',
            changed(
                _LISTENER, ("self.get_logger().info(f'I heard: {msg.data}')", 'print(msg.data)')
            ),
            'What print() writes is not in the log.',
        ),
        Wrong(
            'logs twice',
            changed(
                _LISTENER,
                (
                    "        self.get_logger().info(f'I heard: {msg.data}')\n",
                    "        self.get_logger().info(f'I heard: {msg.data}')\n"
                    '        self.get_logger().info(msg.data)\n',
                ),
            ),
            'would count that text more than once',
        ),
        Wrong(
            'stops after ten',
            changed(
                _LISTENER,
                (
                    "        self.get_logger().info(f'I heard: {msg.data}')\n",
                    '        self.count = getattr(self, "count", 0) + 1\n'
                    '        if self.count <= 10:\n'
                    "            self.get_logger().info(f'I heard: {msg.data}')\n",
                ),
            ),
            'does not log, or it logs something else',
        ),
        Wrong(
            'raises',
            changed(_LISTENER, ('shutil.rmtree(', 'shutil.rmtre(')),
            "has no attribute 'rmtre'",
            outcome=Outcome.ERROR,
        ),
    ],
)
