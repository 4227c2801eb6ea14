"""`%ros2` in a real kernel: the running context, the stop button, the Tab key, processes."""

from __future__ import annotations

import os
import re
import signal
import time

import pytest

SETUP = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import Int16, String
"""
TALKER = """
class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.count = 0
        self.timer = self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data=f'Hello {self.count}'))
        self.count += 1

talker = lab.spin(Talker())
"""


@pytest.fixture
def cell(kernel):
    """Give a function that runs a cell and returns what it shows."""
    assert not kernel.run(SETUP + TALKER).error

    def run(code: str) -> str:
        result = kernel.run(code)
        assert not result.error, result.traceback
        return result.text

    return run


def test_words_use_the_running_context(cell):
    assert cell('%ros2 node list') == '/talker\n'
    assert cell('%ros2 topic list -t') == (
        '/chatter [std_msgs/msg/String]\n'
        '/parameter_events [rcl_interfaces/msg/ParameterEvent]\n'
        '/rosout [rcl_interfaces/msg/Log]\n'
    )
    assert re.fullmatch(r'data: Hello \d+\n---\n', cell('%ros2 topic echo /chatter --once'))
    assert cell('%ros2 topic info /chater') == (
        "Unknown topic '/chater'\nDid you mean '/chatter'?\n"
    )
    assert cell('threads = {t.name for t in __import__("threading").enumerate()}') == ''


def test_each_of_several_commands_is_told_before_its_output(cell):
    assert cell('%ros2 node list\n\n%ros2 topic type /chatter  # a comment') == (
        '$ ros2 node list\n/talker\n$ ros2 topic type /chatter  # a comment\nstd_msgs/msg/String\n'
    )
    # Told before what is wrong with it, too.
    assert cell('%ros2 node lst\n%ros2 node list').startswith('$ ros2 node lst\nros2 node has no')


def test_yaml_braces_and_dollars_are_left_alone(cell):
    cell("""
data = 5
class Ears(Node):
    def __init__(self):
        super().__init__('ears')
        self.heard = []
        self.create_subscription(String, 'words', lambda m: self.heard.append(m.data), 10)
ears = lab.spin(Ears())
""")
    text = cell('%ros2 topic pub --once /words std_msgs/msg/String "{data: \'$data {data}\'}"')
    assert "publishing #1: std_msgs.msg.String(data='$data {data}')" in text
    assert cell('lab.wait_until(lambda: ears.heard)\nears.heard') == "['$data {data}']\n"


ENDLESS = [
    'topic echo /chatter',
    'topic hz /chatter',
    'topic pub /odds std_msgs/msg/Int16',
    'topic echo /nothing',
    'topic pub --once /nobody std_msgs/msg/Int16',
    'service call /nobody std_srvs/srv/Trigger',
]


@pytest.mark.slow('starts other processes')
def test_stop_button_ends_what_goes_on(kernel, cell):
    for line in ENDLESS:
        msg_id = kernel.start(f'print("begin")\n%ros2 {line}')
        kernel.wait_for_output(msg_id, 'begin')
        time.sleep(0.3)  # into the waiting itself; at any other moment it has to work too
        kernel.interrupt()
        result = kernel.finish(msg_id)
        assert not result.error, result.traceback
        assert 'Traceback' not in result.text
        # Nothing of it is left, and ROS still works.
        assert 'Subscription count: 0' in cell('%ros2 topic info /chatter')
        assert cell('%ros2 node list') == '/talker\n'


def test_endless_lines_are_refused_where_nobody_can_stop_them(start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    assert not kernel.run(SETUP + TALKER).error
    result = kernel.run('%ros2 topic echo /chatter')
    assert 'nobody is there to press it.\nAdd --timeout N or --count N.' in result.text
    result = kernel.run('%ros2 topic echo /chatter --count 2 --csv')
    assert len(result.text.splitlines()) == 2


@pytest.mark.slow('starts other processes')
def test_a_cell_shows_no_more_than_it_can_bear(kernel, cell):
    cell("""
class Fast(Node):
    def __init__(self):
        super().__init__('fast')
        self.publisher = self.create_publisher(Int16, 'fast', 10)
        self.create_timer(0.001, lambda: self.publisher.publish(Int16(data=1)))
fast = lab.spin(Fast())
""")
    shown = cell('%ros2 topic echo /fast --csv').splitlines()
    assert shown == [*['1'] * 1000, '1000 messages are shown. Run the cell again to see more.']
    shown = cell('%ros2 topic pub --times 1500 --rate 100000 -w 0 /x std_msgs/msg/Int16')
    assert shown.count('publishing #') == 1000
    assert shown.endswith('1000 messages are shown. It goes on without showing them.\n')


def test_output_of_callbacks_stays_with_its_own_cell(kernel, cell):
    cell("talker.on_message = lambda m: print('heard', m.data)")
    cell("talker.create_subscription(Int16, 'odds', talker.on_message, 10)")
    text = cell('%ros2 topic pub --once /odds std_msgs/msg/Int16 "data: 1"')
    assert 'heard' not in text


def complete(kernel, code: str) -> list[str]:
    reply = kernel._client.complete(code, len(code), reply=True, timeout=60)
    return [match[:] for match in reply['content']['matches']]


TABS = {
    '%ros2 to': ['topic'],
    '%ros2 topic in': ['info'],
    '%ros2 topic echo /ch': ['/chatter'],
    '%ros2 topic echo --onc': ['--once'],
    'x = 1\n%ros2 node info ': ['/talker'],
    '%ros2 topic pub /odds std_msgs/msg/Int16 ': ['"{data: 0}"'],
    '%ros2 interface show std_msgs/msg/Strin': ['std_msgs/msg/String'],
}


@pytest.mark.slow('starts other processes')
def test_tab_key(kernel, cell):
    for code, words in TABS.items():
        assert complete(kernel, code) == words
    assert 'talker' in complete(kernel, 'talk')


RUN = '%ros2 run demo_nodes_py {}'


@pytest.fixture
def lab_kernel(start_kernel, domain):
    kernel = start_kernel(**domain)
    assert not kernel.run(SETUP + 'processes = lab.processes').error
    return kernel


def test_run_starts_processes_that_hear_each_other(lab_kernel):
    started = lab_kernel.start(RUN.format('talker'))
    text = lab_kernel.finish(started).text
    assert text.startswith(
        'demo_nodes_py talker runs in a process of its own, as node /talker. lab.processes() '
        'lists and stops it.\n'
    )
    lab_kernel.wait_for_output(started, '[INFO] [talker]: Publishing: "Hello World: 1"')
    heard = lab_kernel.start(RUN.format('listener'))
    lab_kernel.wait_for_output(heard, '[INFO] [listener]: I heard: [Hello World: ')
    assert lab_kernel.run('%ros2 node list').text == '/listener\n/talker\n'
    assert lab_kernel.run('processes()').text == (
        '0  demo_nodes_py talker: running, /talker\n'
        '1  demo_nodes_py listener: running, /listener\n'
    )
    # A cell that is run again replaces its process.
    assert not lab_kernel.run(RUN.format('talker')).error
    assert lab_kernel.run('%ros2 node list').text == '/listener\n/talker\n'
    waited = lab_kernel.run('processes()[-1].wait_for_lines(2)\nprint(processes()[-1].output[:2])')
    assert waited.text.count('Publishing') == 2
    lab_kernel.run('processes().stop()')
    assert lab_kernel.run('processes()').text == (
        '0  demo_nodes_py listener: ended (exit code 0), /listener\n'
        '1  demo_nodes_py talker: ended (exit code 0), /talker\n'
    )
    assert lab_kernel.run('%ros2 node list').text == ''


def test_run_says_so_when_a_process_fails(lab_kernel):
    result = lab_kernel.run(RUN.format('talker --ros-args --no-such-option'))
    assert 'demo_nodes_py talker ended with exit code 1.' in result.text
    assert '--no-such-option' in result.text


@pytest.mark.slow('starts other processes')
def test_ampersand_sends_a_command_to_the_background(lab_kernel):
    heard = lab_kernel.start('%ros2 topic echo /odds std_msgs/msg/Int16 &')
    assert lab_kernel.finish(heard).text == (
        'ros2 topic echo /odds std_msgs/msg/Int16 runs in the background. lab.processes() lists '
        'and stops it.\n'
    )
    # A subscriber in this process is there at once; the other one has to hear it too.
    lab_kernel.run(
        "ears = Node('ears')\n"
        "ears.create_subscription(Int16, 'odds', lambda msg: None, 10)\n"
        'lab.spin(ears)'
    )
    for number in (1, 3):
        line = f'%ros2 topic pub --once odds std_msgs/msg/Int16 "data: {number}"'
        assert f'Int16(data={number})' in lab_kernel.run(line).text
    lab_kernel.wait_for_output(heard, 'data: 1\n---\ndata: 3\n---\n')
    line = 'ros2 topic echo /odds std_msgs/msg/Int16'
    assert lab_kernel.run('processes()').text == f'0  {line}: running\n'
    lab_kernel.run('processes().stop()')
    assert lab_kernel.run('processes()').text == f'0  {line}: ended (exit code 2)\n'


def test_ampersand_refuses_a_bad_line_at_once(lab_kernel):
    text = lab_kernel.run('%ros2 topic eco /odds &').text
    assert text.startswith("ros2 topic has no verb 'eco'. Did you mean 'echo'?\n")
    text = lab_kernel.run('%ros2 topic echo /odds & node list').text
    assert text.startswith("'&' belongs to a terminal; %ros2 runs one command.\n")
    assert lab_kernel.run('processes()').text == 'No process was started with %ros2 run.\n'
    text = lab_kernel.run('%ros2 topic pub -w 0 --once /x std_msgs/msg/String "&"').text
    assert "in YAML format, but it is '&'" in text or 'can not be read as YAML' in text


def test_exclamation_mark_finds_the_ros2_of_the_environment(start_kernel, domain):
    kernel = start_kernel(PATH='/usr/bin:/bin', **domain)
    assert not kernel.run(SETUP + TALKER).error
    shown = kernel.run('!ros2 node list').outputs
    said = ''.join(each['text'] for each in shown if each['output_type'] == 'stream')
    assert said.split() == ['/talker']


@pytest.mark.slow('starts other processes')
def test_stopped_process_has_left_the_graph(lab_kernel):
    lab_kernel.run(RUN.format('talker'))
    assert lab_kernel.run('processes().stop()\n%ros2 node list').text == ''


def _alive(pid: int) -> bool:
    try:
        with open(f'/proc/{pid}/stat') as file:
            return file.read().rpartition(')')[2].split()[0] != 'Z'
    except (FileNotFoundError, ProcessLookupError):  # it may end while it is read
        return False


PIDS = """
from pathlib import Path
supervisor = processes()[0]._supervisor.pid
child = Path(f'/proc/{supervisor}/task/{supervisor}/children').read_text().split()[0]
print(supervisor, child)
"""


@pytest.mark.slow('starts other processes')
@pytest.mark.parametrize('how', ['kill the kernel', 'shut down', 'kill the supervisor'])
def test_processes_end_with_the_kernel_whatever_ends_it(lab_kernel, how):
    assert not lab_kernel.run(RUN.format('talker')).error
    supervisor, child = map(int, lab_kernel.run(PIDS).text.split())
    assert _alive(supervisor) and _alive(child)
    if how == 'kill the kernel':
        os.kill(lab_kernel.process.pid, signal.SIGKILL)
        lab_kernel.process.wait()
    elif how == 'shut down':
        assert lab_kernel.shutdown() == 0
    else:
        os.kill(supervisor, signal.SIGKILL)
    end = time.monotonic() + 60
    while (_alive(supervisor) or _alive(child)) and time.monotonic() < end:
        time.sleep(0.05)
    assert not _alive(child) and not _alive(supervisor)
