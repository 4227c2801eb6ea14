"""Messages are counted without a trace in the graph."""

from __future__ import annotations

import pytest

from labkit.background.domains import claim_domain

STAGE = """
import labkit as lab
from labkit.asking import traffic
from labkit.background.runtime import runtime
from labkit.rosgraph.snapshot import read_graph
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int16, String

lab.start()
talker, listener = lab.spin(Node('talker')), lab.spin(Node('listener'))
publisher = talker.create_publisher(String, 'chatter', 10)
heard = []
subscription = listener.create_subscription(String, 'chatter', heard.append, 10)

def say(times=1, publisher=publisher):
    for _ in range(times):
        publisher.publish(String(data='hello'))

def topics():
    return read_graph(runtime.helper).topics

counter = traffic.Traffic()

def passed():
    return sorted(counter.passed(topics()).items())
"""


@pytest.fixture
def run(kernel):
    def run(code: str) -> str:
        result = kernel.run(code)
        assert not result.error, result.traceback
        return result.text.strip()

    run(STAGE)
    return run


def test_counts_what_is_published_and_heard_while_it_is_open(run):
    run('say(3)\nlab.wait_until(lambda: len(heard) == 3)\ncounter.open()')
    assert run('print(passed())') == '[]'
    run('say(4)\nlab.wait_until(lambda: len(heard) == 7)')
    assert run('print(passed())') == (
        "[(('hears', '/listener', '/chatter'), 4), (('publishes', '/talker', '/chatter'), 4)]"
    )
    assert run('print(passed())') == '[]'
    # Nobody hears it, and a node that nobody spins hears nothing.
    run('deaf = Node("deaf")\ndeaf.create_subscription(String, "chatter", print, 10)')
    run('other = talker.create_publisher(String, "other", 10)\nsay(2, other)\nsay()')
    run('lab.wait_until(lambda: len(heard) == 8)')
    assert run('print(passed())') == (
        "[(('hears', '/listener', '/chatter'), 1), (('publishes', '/talker', '/chatter'), 1), "
        "(('publishes', '/talker', '/other'), 2)]"
    )


def test_a_node_that_takes_the_place_of_another_begins_anew(run):
    run('counter.open()\nsay(5)\npassed()')
    run(
        'talker = lab.spin(Node("talker"))\nsay(2, talker.create_publisher(String, "chatter", 10))'
    )
    assert "('publishes', '/talker', '/chatter'), 2" in run('print(passed())')


def test_nothing_is_left_when_it_is_closed(run):
    run('counter.open()\ncounter.open()\nsecond = traffic.Traffic()\nsecond.open()')
    run('counter.close()\ncounter.close()\nsay(2)')
    assert "'/talker', '/chatter'), 2" in run('print(sorted(second.passed(topics()).items()))')
    run('second.close()')
    assert run('print(traffic._open)') == 'set()'


def test_in_one_process_nobody_subscribes(run):
    run('counter.open()\ncounter.listen_to_others(topics())')
    assert run('print(publisher.get_subscription_count(), counter._node)') == '1 None'


# Another process; a domain of the test's own lets the two find each other.
OTHER = """
import sys
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
node = lab.spin(Node(sys.argv[1]))
ends = [node.create_publisher(String, 'news', 10)]
ends.append(node.create_subscription(String, 'chatter', lambda msg: None, 10))
node.create_timer(0.02, lambda: ends[0].publish(String(data='news')))
print('ready', flush=True)
input()
"""


@pytest.fixture
def run_beside(start_kernel):
    claim = claim_domain()
    kernel = start_kernel(
        ROS_DOMAIN_ID=str(claim.domain_id), ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST'
    )

    def run(code: str) -> str:
        result = kernel.run(code)
        assert not result.error, result.traceback
        return result.text.strip()

    run(STAGE)
    run(f'OTHER = {OTHER!r}')
    run("""
import subprocess, sys
def start(name):
    other = subprocess.Popen(
        [sys.executable, '-c', OTHER, name], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    other.stdout.readline()
    def who(topic_name, kind):
        found = [getattr(topic, kind) for topic in topics() if topic.name == topic_name]
        return {end.node for ends in found for end in ends}
    # One of them may be discovered long before the other.
    lab.wait_until(
        lambda: f'/{name}' in who('/news', 'publishers') & who('/chatter', 'subscriptions'),
        timeout_sec=50,
    )
    return other
""")
    yield run
    run('[other.communicate(b"\\n", timeout=30) for other in others]')
    claim.close()


# Between cells, while the kernel is idle.
COUNT = """
import asyncio
total = {}
async def count(way, number):
    counter._on_cell_end()  # this cell is no cell of a learner's
    while total.get(way, 0) < number:
        counter.listen_to_others(topics())
        for each, new in counter.passed(topics()).items():
            total[each] = total.get(each, 0) + new
        await asyncio.sleep(0.05)
"""


@pytest.mark.slow('starts other processes')
def test_publishers_of_other_processes_are_heard_between_cells(run_beside):
    run = run_beside
    run('others = [start("other")]\ncounter.open()\n' + COUNT)
    run('await count(("publishes", "/other", "/news"), 20)')
    # It begins with nothing, and ends with the next cell: nobody sees it there.
    listening = 'print(talker.count_subscribers("/news"), counter._node)'
    assert run(listening) == '0 None'
    assert run('counter.listen_to_others(topics())\n' + listening) == '0 None'
    # So this process may have another type there.
    run('lab.spin(Node("mine")).create_subscription(Int16, "news", print, 10)')
    run('counter._on_cell_end()\ncounter.listen_to_others(topics())')
    assert run('print(counter._heard)') == '{}'


@pytest.mark.slow('starts other processes')
def test_what_another_process_hears_is_what_it_was_sent(run_beside):
    run = run_beside
    run('others = [start("other")]\ncounter.open()\nsay(3)\nnew = dict(passed())')
    assert run('print(new["hears", "/other", "/chatter"])') == '3'


@pytest.mark.slow('other processes, in real time')
def test_of_several_other_publishers_none_is_said_to_have_sent_it(run_beside):
    run = run_beside
    run('others = [start("one"), start("two")]\ncounter.open()\n' + COUNT)
    run('lab.spin(Node("ear")).create_subscription(String, "news", lambda msg: None, 10)')
    run('await count(("hears", "/ear", "/news"), 20)')
    assert run('print([way for way in total if way[0] == "publishes"])') == '[]'
