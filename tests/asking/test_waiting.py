"""Waiting in a real kernel: results, and messages when nothing comes."""

from __future__ import annotations

from contextlib import closing

import pytest

from labkit.background import domains

SETUP = """
import threading, time
from contextlib import contextmanager
from types import SimpleNamespace
import labkit as lab
from labkit.background import wait
from labkit.background.runtime import runtime
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int16, String

class Speaker(Node):
    def __init__(self, topic='/chatter', qos=10, name='speaker'):
        super().__init__(name)
        self.count = 0
        self.publisher = self.create_publisher(String, topic, qos)
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data=f'{self.count}'))
        self.count += 1

class Ear(Node):
    def __init__(self, topic='/chatter', msg_type=String, qos=10):
        super().__init__('ear')
        self.heard = []
        self.create_subscription(msg_type, topic, self.heard.append, qos)

class Stuck(Speaker):
    # Its callback runs, and does not return, within the `with` block.
    def __init__(self):
        super().__init__()
        self.begun, self.hold = threading.Event(), threading.Event()
        self.create_timer(0.01, self.get_stuck)

    def get_stuck(self):
        self.begun.set()
        self.hold.wait(60)

    def __enter__(self):
        lab.spin(self)
        assert self.begun.wait(30)

    def __exit__(self, *_):
        self.hold.set()

@contextmanager
def over_after(more, count):
    # Who waits for up to 50 s waits until `count()` has grown by so many: however long it takes a
    # busy machine, and no longer.
    before = None
    def monotonic():
        nonlocal before
        if before is None:
            before = count()
        return time.monotonic() + (50 if count() >= before + more else 0)
    wait.time = SimpleNamespace(monotonic=monotonic)
    try:
        yield
    finally:
        wait.time = time

def failures():
    return sum(error.count for error in runtime.console.errors)
"""


@pytest.fixture
def lab(kernel):
    """Return a kernel with the classes above."""
    result = kernel.run(SETUP)
    assert not result.error, result.traceback
    return kernel


def test_wait_for_message_and_listen_return_messages_in_order(lab):
    result = lab.run(
        'lab.spin(Speaker())\n'
        'first = lab.wait_for_message("/chatter", String)\n'
        'more = lab.listen("chatter", String, count=5)\n'
        'numbers = [int(m.data) for m in more]\n'
        'print(type(first).__name__, numbers == list(range(numbers[0], numbers[0] + 5)))'
    )
    assert (result.error, result.text) == ('', 'String True\n')


def test_listening_leaves_no_subscription(lab):
    lab.run('speaker = lab.spin(Speaker())\nlab.listen("/chatter", String, count=2)')
    result = lab.run(
        'lab.wait_until(lambda: speaker.publisher.get_subscription_count() == 0)\nprint("none")'
    )
    assert result.text == 'none\n'


def test_wait_for_subscribers(lab):
    code = 'speaker = lab.spin(Speaker())\near = lab.spin(Ear())\n'
    assert not lab.run(f'{code}lab.wait_for_subscribers(speaker.publisher)').error
    few = lab.run('lab.wait_for_subscribers(speaker.publisher, count=2, timeout_sec=0.1)')
    assert 'for 2 subscriber(s) of /chatter, but 1 came' in few.error


def test_condition_of_something_else_than_ros(lab):
    code = (
        'import threading\nflag = threading.Event()\n'
        'threading.Timer(0.05, flag.set).start()\nlab.wait_until(flag.is_set)'
    )
    assert not lab.run(code).error


def test_what_a_condition_raises_reaches_the_cell(lab):
    assert lab.run('lab.wait_until(lambda: 1 / 0)').error.startswith('ZeroDivisionError')
    lab.run('speaker = lab.spin(Speaker())')
    later = lab.run('lab.wait_until(lambda: speaker.count > 2 and speaker.cuont)')
    assert later.error.startswith('AttributeError')


TIMEOUTS = {
    'nobody publishes': (
        'lab.wait_for_message("/silence", String, timeout_sec=0.1)',
        'Nobody publishes on /silence.',
    ),
    'incompatible reliability': (
        'qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)\n'
        'lab.spin(Speaker(qos=qos))\n'
        'lab.wait_for_message("/chatter", String, timeout_sec=0.2, qos_profile=10)',
        'its QoS profile does not match',
    ),
    'incompatible durability': (
        'qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n'
        'lab.spin(Speaker())\n'
        'lab.wait_for_message("/chatter", String, timeout_sec=0.2, qos_profile=qos)',
        'its QoS profile does not match',
    ),
    'a letter': (
        'lab.spin(Speaker())\nlab.wait_for_message("/chater", String, timeout_sec=0.2)',
        'somebody does on /chatter. Is one of the two misspelt?',
    ),
    'a capital letter': (
        'lab.spin(Speaker())\nlab.wait_for_message("/Chatter", String, timeout_sec=0.2)',
        'somebody does on /chatter',
    ),
    'a namespace': (
        'lab.spin(Speaker("/robot/chatter"))\n'
        'lab.wait_for_message("/chatter", String, timeout_sec=0.2)',
        'somebody does on /robot/chatter: the same name in another namespace',
    ),
    'a publisher that is silent': (
        'node = lab.spin(Node("mute"))\nnode.create_publisher(String, "chatter", 10)\n'
        'lab.wait_for_message("/chatter", String, timeout_sec=0.2)',
        '/mute has a publisher on /chatter with the right type and QoS, but nothing came from it '
        'in that time. Maybe its timer does not run, or publish() is not reached.',
    ),
    'a publisher that is not active': (
        'from rclpy.lifecycle import LifecycleNode\n'
        'node = lab.spin(LifecycleNode("cycle"))\n'
        'node.create_lifecycle_publisher(String, "chatter", 10)\nnode.trigger_configure()\n'
        'lab.wait_for_message("/chatter", String, timeout_sec=0.2)',
        '/cycle has a life cycle, and its state is inactive: it publishes only while it is '
        'active. Its service /cycle/change_state does that: transition {id: 3}.',
    ),
    'an active publisher that is silent': (
        'from rclpy.lifecycle import LifecycleNode\n'
        'node = lab.spin(LifecycleNode("cycle"))\n'
        'node.create_lifecycle_publisher(String, "chatter", 10)\n'
        'node.trigger_configure()\nnode.trigger_activate()\n'
        'lab.wait_for_message("/chatter", String, timeout_sec=0.2)',
        'Maybe its timer does not run, or publish() is not reached.',
    ),
    'too few messages': (
        'speaker = lab.spin(Speaker())\nwith over_after(10, lambda: speaker.count):\n'
        '    lab.listen("/chatter", String, count=10000, timeout_sec=50)',
        'Maybe they come more slowly than that.',
    ),
    'a publisher that nobody spins': (
        'idle = Speaker()\nlab.wait_for_message("/chatter", String, timeout_sec=0.2)',
        '/speaker is not spun: lab.spin(...) does that.',
    ),
    'a publisher whose callback fails': (
        'class Broken(Speaker):\n    def on_timer(self):\n        1 / 0\n'
        'lab.spin(Broken())\nwith over_after(1, failures):\n'
        '    lab.wait_for_message("/chatter", String, timeout_sec=50)',
        'Meanwhile the callback on_timer of /speaker failed: ZeroDivisionError',
    ),
    'another callback that does not return': (
        'with Stuck():\n    lab.listen("/chatter", String, count=10000, timeout_sec=0.3)',
        'of /speaker is still running; while it runs, no other callback can',
    ),
    'condition, no node': (
        'lab.wait_until(lambda: 1 > 2, timeout_sec=0.1)',
        'for 1 > 2, but it did not become true.\nNo node runs in this notebook.',
    ),
    'condition, own subscription misspelt': (
        'lab.spin(Speaker())\near = lab.spin(Ear("/chater"))\n'
        'lab.wait_until(lambda: ear.heard, timeout_sec=0.2)',
        '/ear subscribes to /chater. Nobody publishes on /chater, but somebody does on /chatter',
    ),
    'condition, a callback that fails': (
        'speaker = Speaker()\nspeaker.publisher = None\nlab.spin(speaker)\n'
        'with over_after(1, failures):\n'
        '    lab.wait_until(lambda: speaker.count, timeout_sec=50)',
        'Meanwhile the callback on_timer of /speaker failed: AttributeError',
    ),
    'condition, a callback that does not return': (
        'with Stuck():\n    lab.wait_until(lambda: False, timeout_sec=0.3)',
        'of /speaker is still running; while it runs, no other callback can',
    ),
    'condition that is wrong': (
        'speaker = lab.spin(Speaker())\n'
        'lab.wait_until(lambda: speaker.count < 0, timeout_sec=0.2)',
        'Running here: /speaker',
    ),
    'subscribers of another name': (
        'ear = lab.spin(Ear("/chater"))\nspeaker = lab.spin(Speaker())\n'
        'lab.wait_for_subscribers(speaker.publisher, timeout_sec=0.2)',
        'Somebody subscribes to /chater. Is one of the two names misspelt?',
    ),
}


@pytest.mark.slow('it waits in vain, several times')
def test_a_timeout_names_the_likeliest_cause(lab):
    wrong = []
    for name, (code, expected) in TIMEOUTS.items():
        result = lab.run(code)
        if not result.error.startswith('LabTimeout: Waited') or expected not in result.error:
            wrong.append(f'{name}: {result.error or "no error"}')
        assert 'waiting.py' not in result.traceback
        lab.run('lab.stop()')
    assert not wrong, '\n'.join(wrong)


def test_wrong_arguments_are_answered_in_words(lab):
    for code, expected in (
        ('lab.wait_until(True)', 'Write lambda: before the condition'),
        ('lab.wait_until(lambda: True, timeout_sec="5")', 'timeout_sec must be a number'),
        ('lab.wait_for_message("/a", "String")', 'must be a message class'),
        ('lab.wait_for_message("/a b", String)', "'/a b' is no name of a topic"),
        ('lab.listen("/a", String, count=0)', 'count must be a whole number of at least 1'),
        ('lab.wait_for_subscribers(3)', 'expects a publisher, but got 3'),
        ('lab.wait_for_massage', "module 'labkit' has no attribute 'wait_for_massage'"),
    ):
        result = lab.run(code)
        assert expected in result.error, code


def test_two_types_on_a_topic_of_one_notebook_are_refused_in_words(lab):
    lab.run('lab.spin(Speaker())')
    for code in (
        'lab.wait_for_message("/chatter", Int16)',
        'Ear(msg_type=Int16)',
        'Node("other").create_publisher(Int16, "chatter", 10)',
    ):
        result = lab.run(code)
        assert result.error.startswith('LabError'), code
        assert 'In one notebook, a topic has one type' in result.error
        assert '/speaker uses /chatter with messages of another type' in result.error
        assert 'pasted.py' not in result.traceback


OTHER_PROCESS = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import Int16, String

node = lab.spin(Node('elsewhere'))
publisher = node.create_publisher(String, 'words', 10)
node.create_timer(0.02, lambda: publisher.publish(String(data='hello')))
node.create_subscription(Int16, 'numbers', lambda msg: None, 10)
print('ready', flush=True)
input()
"""


@pytest.mark.slow('starts another process')
def test_another_type_in_another_process_is_named(start_kernel):
    lab = start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    assert not lab.run(SETUP).error
    lab.run(f'program = {OTHER_PROCESS!r}')
    lab.run(
        'import subprocess, sys\nlab.start()\n'
        'other = subprocess.Popen([sys.executable, "-c", program],'
        ' stdin=subprocess.PIPE, stdout=subprocess.PIPE)\n'
        'print(other.stdout.readline())\n'
        'from labkit.rosgraph.endpoints import publishers, subscriptions\n'
        'def is_known():\n'
        '    ends = [*publishers(runtime.helper, "/words")]\n'
        '    ends += subscriptions(runtime.helper, "/numbers")\n'
        '    return [end.node for end in ends] == 2 * ["/elsewhere"]\n'
        'lab.wait_until(is_known, timeout_sec=50)\n'
        'lab.wait_until(lambda: "/elsewhere" in runtime.foreign_nodes(), timeout_sec=50)'
    )
    try:
        heard = lab.run('lab.wait_for_message("/words", Int16, timeout_sec=0.2)')
        assert '/elsewhere publishes on /words, but messages of another type' in heard.error
        own = lab.run(
            'ear = lab.spin(Ear("words", Int16))\n'
            'lab.wait_until(lambda: ear.heard, timeout_sec=0.2)'
        )
        assert '/ear subscribes to /words. /elsewhere publishes on /words' in own.error
        asked = lab.run(
            'speaker = lab.spin(Speaker("numbers"))\n'
            'lab.wait_for_subscribers(speaker.publisher, timeout_sec=0.2)'
        )
        assert '/elsewhere subscribes to /numbers, but to std_msgs/msg/Int16' in asked.error
        removed = lab.run('lab.remove("elsewhere")')
        assert 'It runs in another process: end it where that was started.' in removed.error
    finally:
        lab.run('other.kill(), other.wait()')


KILLED = """
import labkit as lab, subprocess, sys
from labkit.background.runtime import runtime
from labkit.rosgraph.endpoints import publishers
from rclpy.node import Node
from std_msgs.msg import String

code = 'import rclpy, sys\\nfrom std_msgs.msg import String\\nrclpy.init()\\n'
code += 'node = rclpy.create_node("talker")\\nnode.create_publisher(String, "chatter", 10)\\n'
other = subprocess.Popen([sys.executable, '-c', code + 'sys.stdin.read()'], stdin=-1)
lab.spin(Node('talker'))
lab.wait_until(
    lambda: '/talker' in runtime.foreign_nodes()
    and [end.node for end in publishers(runtime.helper, '/chatter')] == ['/talker'],
    timeout_sec=60,
)

def ask():
    try:
        lab.wait_for_message('/chatter', String, timeout_sec=0.1)
    except lab.LabTimeout as error:
        print(error)
    print(*(line.seen for line in lab.doctor().lines if line.name == 'Nodes'))

ask()
other.kill()
other.wait()
print('LATER')
ask()
"""


def test_a_process_that_was_killed_is_looked_up(script):
    with closing(domains.claim_domain()) as claim:
        env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
        done = script(KILLED, **env)
    assert done.exit_code == 0, done.stderr
    living, killed = done.stdout.split('LATER')
    assert 'Maybe its timer does not run' in living
    assert 'Another process has a node called /talker, too.' in living
    assert 'Maybe it was killed: the graph forgets it only after 20 s.' in killed
    assert 'this machine has no process with its number' in killed
