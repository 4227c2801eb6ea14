"""The runtime in a real kernel: cells run again, callbacks that fail, the stop button."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from tests.background.cells import LISTENER, SETUP, TALKER

COUNTS = """
import threading
from labkit.background.runtime import runtime
infos = runtime.helper.get_publishers_info_by_topic('/chatter')
subscribers = runtime.helper.get_subscriptions_info_by_topic('/chatter')
names = [name for name in runtime.helper.get_node_names() if not name.startswith('_')]
print(sorted(names), len(infos), len(subscribers), threading.active_count())
"""


@pytest.mark.slow('runs a lesson a hundred times')
def test_cells_run_100_times_leave_one_node_of_each_kind(kernel):
    assert not kernel.run(SETUP + TALKER + LISTENER).error
    kernel.run('lab.wait_until(lambda: listener.heard)')
    threads = kernel.run(COUNTS).text.split()[-1]
    for _ in range(100):
        result = kernel.run(TALKER + LISTENER)
        assert not result.error, result.traceback
    assert kernel.run('lab.wait_until(lambda: len(listener.heard) > 20)').error == ''
    # A destroyed node leaves the graph once the background thread has released it.
    kernel.run('lab.wait_until(lambda: len(runtime.helper.get_node_names()) == 3)')
    assert kernel.run(COUNTS).text.strip() == f"['listener', 'talker'] 1 1 {threads}"
    once = kernel.run('print(len(listener.heard) == len(set(listener.heard)))')
    assert once.text.strip() == 'True'
    timers = kernel.run('print([len(list(node.timers)) for node in runtime.executor.get_nodes()])')
    assert timers.text.strip() == '[1, 1, 0]'


def test_error_in_a_callback_is_shown_under_its_cell_and_spinning_goes_on(kernel):
    kernel.run(SETUP)
    broken = TALKER.replace('self.count += 1', 'self.count += 1\n        self.publisher.publsh()')
    cell = kernel.run(broken)
    later = kernel.run('lab.wait_until(lambda: talker.count >= 12)')
    assert (later.error, later.text) == ('', '')
    shown = kernel.wait_for_output(cell.msg_id, '10 times by now')
    assert "AttributeError: 'Publisher' object has no attribute 'publsh'" in shown
    assert 'self.publisher.publsh()' in shown
    assert shown.count('The callback on_timer of /talker failed') == 1
    assert 'site-packages' not in shown
    assert 'labkit' not in shown


def test_prints_logs_and_errors_come_in_order_under_the_cell_that_started_the_node(kernel):
    kernel.run(SETUP)
    cell = kernel.run(
        TALKER.replace(
            'self.count += 1',
            """self.count += 1
        print('print', self.count)
        self.get_logger().debug(f'debug {self.count}')
        self.get_logger().info(f'info {self.count}')
        self.get_logger().warning(f'warning {self.count}')
        self.get_logger().error(f'error {self.count}')
        self.get_logger().fatal(f'fatal {self.count}')
        print('after', self.count)
""",
        )
    )
    other = kernel.run('lab.wait_until(lambda: talker.count >= 2)\nprint("mine")')
    assert other.text == 'mine\n'
    kernel.wait_for_output(cell.msg_id, 'after 2')
    lines = kernel.wait_for_output(cell.msg_id, 'after 2').splitlines()
    assert lines[:6] == [
        'print 1',
        '[INFO] [talker]: info 1',
        '[WARN] [talker]: warning 1',
        '[ERROR] [talker]: error 1',
        '[FATAL] [talker]: fatal 1',
        'after 1',
    ]


def test_output_of_a_cell_is_bounded(kernel):
    kernel.run(SETUP)
    cell = kernel.run(
        TALKER.replace('self.count += 1', 'self.count += 1\n        print("x\\n" * 30)')
    )
    kernel.run('lab.wait_until(lambda: talker.count >= 20)')
    shown = kernel.wait_for_output(cell.msg_id, '200 lines are shown').splitlines()
    assert len(shown) == 201
    again = kernel.run('talker = lab.spin(Talker())')
    assert 'x' in kernel.wait_for_output(again.msg_id, 'x')


@pytest.mark.parametrize(
    'waiting',
    [
        'lab.wait_until(lambda: False, timeout_sec=None)',
        'lab.wait_for_message("/nothing", String, timeout_sec=None)',
        'import rclpy\nrclpy.spin(Node("idle"))',
        'import rclpy\nrclpy.spin_once(Node("idle"))',
        'client.call(Trigger.Request())',
        """
from rclpy.executors import MultiThreadedExecutor
executor = MultiThreadedExecutor()
executor.add_node(Node("idle"))
executor.spin()""",
    ],
)
def test_stop_button_ends_the_cell_and_ros_still_works(kernel, waiting):
    kernel.run(SETUP + TALKER)
    kernel.run(
        'from std_srvs.srv import Trigger\n'
        'client = lab.spin(Node("asking")).create_client(Trigger, "nobody")'
    )
    cell = kernel.start(f'print("waiting", flush=True)\n{waiting}')
    kernel.wait_for_output(cell, 'waiting')
    kernel.interrupt()
    result = kernel.finish(cell)
    assert result.error.split(':')[0] in ('', 'KeyboardInterrupt')
    after = kernel.run(
        LISTENER + 'lab.wait_until(lambda: len(listener.heard) >= 3)\nprint("works")'
    )
    assert (after.error, after.text) == ('', 'works\n')


def test_waiting_inside_a_callback_is_refused(kernel):
    kernel.run(SETUP)
    call = TALKER.replace(
        'self.count += 1', "self.count += 1\n        lab.wait_for_message('/chatter', String)"
    )
    cell = kernel.run(call)
    shown = kernel.wait_for_output(cell.msg_id, 'LabError')
    assert 'Waiting inside a callback would wait for ever' in shown


DONE_CALLBACKS = """
from std_srvs.srv import Trigger

class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.answers = []
        self.client = self.create_client(Trigger, 'ask')
        self.create_service(Trigger, 'ask', self.on_request)
        self.timer = self.create_timer(0.02, self.on_timer)

    def on_request(self, request, response):
        response.message = 'yes'
        return response

    def on_timer(self):
        self.timer.cancel()
        self.client.call_async(Trigger.Request()).add_done_callback(self.on_answer)

    def on_answer(self, future):
        self.answers.append(future.result().message)
        print('heard', self.answers)
        if len(self.answers) > 1:
            raise RuntimeError('enough')

asker = lab.spin(Asker())
lab.wait_until(lambda: asker.answers)
"""


def test_callbacks_added_to_a_future_are_run_and_speak_under_the_cell_of_their_node(kernel):
    assert not kernel.run(SETUP).error
    msg_id = kernel.start(DONE_CALLBACKS)
    assert kernel.finish(msg_id).text == "heard ['yes']\n"
    again = (
        'asker.client.call_async(Trigger.Request()).add_done_callback(asker.on_answer)\n'
        'lab.wait_until(lambda: len(asker.answers) > 1)'
    )
    assert not kernel.run(again).error
    shown = kernel.wait_for_output(msg_id, 'RuntimeError: enough')
    assert "heard ['yes', 'yes']" in shown
    assert 'The callback on_answer of /asker failed.' in shown


def test_stop_and_start_again(kernel):
    kernel.run(SETUP + TALKER)
    result = kernel.run(
        'lab.stop()\nimport rclpy, threading\n'
        'print(rclpy.ok(), [t.name for t in threading.enumerate() if t.name == "labkit"])'
    )
    assert result.text == 'False []\n'
    assert kernel.run('lab.start()\nprint(rclpy.ok())').text == 'True\n'
    assert kernel.run(TALKER + 'lab.wait_until(lambda: talker.count)').error == ''


def test_spin_starts_ros_by_itself(kernel):
    assert kernel.run(SETUP + TALKER + 'lab.wait_until(lambda: talker.count)').error == ''


def test_wrong_arguments_are_answered_in_words(kernel):
    kernel.run(SETUP + TALKER)
    here = kernel.run('import os\nprint(os.environ["ROS_DOMAIN_ID"])').text
    elsewhere = 7 if here != '7\n' else 8
    for code, expected in (
        ('lab.spin(Talker)', 'Make a node of it: lab.spin(Talker())'),
        ('lab.spin(3)', 'lab.spin() expects a node, but got 3.'),
        ('lab.remove("talcer")', "Did you mean '/talker'?"),
        ('lab.start(domain_id=500)', 'domain_id must be a whole number from 0 to 101'),
        (f'lab.start(domain_id={elsewhere})', f'move to domain {elsewhere} only without nodes'),
        ('lab.remove(talker)\nlab.spin(talker)', 'This Talker exists no more: it was destroyed.'),
        (
            'class Mute(Node):\n    def __init__(self):\n        pass\nlab.spin(Mute())',
            'This Mute is not a node yet: its __init__ has not called the one of Node.',
        ),
    ):
        result = kernel.run(code)
        assert expected in result.error, code
        assert result.error.startswith('LabError')
        assert 'site-packages' not in result.traceback
        assert 'runtime.py' not in result.traceback


def test_a_half_made_node_is_gone_when_its_cell_is_run_again(kernel):
    kernel.run(SETUP)
    failed = kernel.run(TALKER.replace('self.create_timer(0.02', 'self.creat_timer(0.02'))
    assert failed.error.startswith('AttributeError')
    assert kernel.run(TALKER).error == ''
    kernel.run(
        'from labkit.rosgraph.snapshot import node_names\n'
        'from labkit.background.runtime import runtime'
    )
    gone = 'lab.wait_until(lambda: node_names(runtime.helper).count("/talker") == 1)'
    assert kernel.run(gone).error == ''


def test_a_cell_that_forgot_to_set_its_node_up_can_be_mended(kernel):
    kernel.run(SETUP)
    forgot = re.sub(r'super\(\).__init__\(.*\)', 'pass', TALKER)
    failed = kernel.run(forgot, cell_id='talker')
    assert "no attribute '_Node__node'" in failed.error
    assert kernel.run(TALKER, cell_id='talker').error == ''


def test_wrong_values_in_messages_are_refused_at_once(kernel):
    kernel.run('import labkit as lab')
    kernel.run('from std_msgs.msg import Int16\nfrom geometry_msgs.msg import Twist')
    for code, expected in (
        ('Int16(data=40000)', "The 'data' field must be an integer in [-32768, 32767]"),
        ("Int16(data='a')", "The 'data' field must be of type 'int'"),
        ('Twist().linear.x = 1', "The 'x' field must be of type 'float'"),
    ):
        assert expected in kernel.run(code).error


def test_message_classes_loaded_before_labkit_check_their_fields_too(kernel):
    kernel.run('from std_msgs.msg import Int16\nInt16(data=40000)')
    assert 'AssertionError' in kernel.run('import labkit\nInt16(data=40000)').error


@pytest.mark.slow('waits in real time')
def test_headless_output_of_callbacks_is_cut_where_the_wait_ended(
    start_kernel: Callable[..., object],
):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run(SETUP)
    loud = TALKER.replace('self.count += 1', 'self.count += 1\n        print(self.count)')
    for _ in range(20):
        result = kernel.run(f'{loud}lab.wait_until(lambda: talker.count >= 3)')
        assert kernel.run('1').error == ''
        assert ''.join(o['text'] for o in kernel.outputs_of(result.msg_id)) == '1\n2\n3\n'


@pytest.mark.parametrize(
    'struck', ['Runtime._add_helper', 'BackgroundExecutor.__init__', 'BackgroundExecutor.start']
)
def test_a_start_that_the_stop_button_ends_half_way_is_made_up_for(kernel, struck):
    kernel.run(SETUP + 'lab.start(); lab.stop()')
    half = kernel.run(
        'from labkit.background.runtime import BackgroundExecutor, Runtime\n'
        f'original = {struck}\n'
        'def strike(*args):\n'
        f'    {struck} = original\n'
        '    raise KeyboardInterrupt\n'
        f'{struck} = strike\n'
        'lab.start()'
    )
    assert half.error.startswith('KeyboardInterrupt')
    assert not kernel.run(TALKER).error
    assert not kernel.run("lab.wait_for_message('/chatter', String)").error
    assert kernel.shutdown() == 0


def test_stop_waits_neither_for_a_callback_to_come_nor_for_one_that_waits_for_it(script):
    result = script(
        'import labkit as lab\n'
        'from labkit.background.runtime import runtime\n'
        'lab.start()\n'
        'for timer in runtime.helper.timers:\n'
        '    timer.cancel()\n'
        'assert runtime.executor.close(30)\n'
        'from rclpy.node import Node\n'
        'node = lab.spin(Node("busy"))\n'
        'node.create_timer(0.0, runtime.nodes)\n'
        'lab.wait_until(lambda: runtime.nodes()[0].callbacks > 3)\n'
        'executor = runtime.executor\n'
        'close, ended = executor.close, []\n'
        'executor.close = lambda timeout_sec: ended.append(close(timeout_sec))\n'
        'lab.stop()\n'
        'print(ended)\n'
    )
    assert (result.exit_code, result.stdout) == (0, '[True]\n'), result.stderr


def test_streams_of_a_kernel_answer_as_before(kernel):
    ask = """
import sys
for stream in (sys.stdout, sys.stderr):
    print(stream.encoding, stream.isatty(), stream.writable(), stream.fileno() > 0)
"""
    before = kernel.run(ask).text
    assert before.startswith('UTF-8 False True True\n')
    assert kernel.run('import labkit as lab\nlab.start()' + ask).text == before
