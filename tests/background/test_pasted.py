"""Code as it stands in tutorials, pasted into a cell: rclpy's own functions in a kernel."""

from __future__ import annotations

from tests.background.cells import SETUP, TALKER

PASTED = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Minimal(Node):
    def __init__(self):
        super().__init__('minimal')
        self.publisher = self.create_publisher(String, 'topic', 10)
        self.timer = self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='tick'))
        self.get_logger().info('tick')

def main(args=None):
    rclpy.init(args=args)
    node = Minimal()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()

main()
print('the end')
"""


def test_pasted_tutorial_works_twice_and_labkit_after_it(kernel):
    kernel.run('import labkit as lab\nlab.start()')
    for _ in range(2):
        cell = kernel.start(PASTED)
        kernel.wait_for_output(cell, '[INFO] [minimal]: tick')
        kernel.interrupt()
        result = kernel.finish(cell)
        assert (result.error, result.text.splitlines()[-1]) == ('', 'the end')
    result = kernel.run(SETUP + TALKER + 'lab.wait_until(lambda: talker.count >= 2)')
    assert result.error == ''


def test_functions_of_rclpy_do_what_their_documentation_says(kernel):
    kernel.run(SETUP + 'import rclpy\nlab.start()')
    kernel.run(TALKER.replace('lab.spin(Talker())', 'Talker()'))
    counts = kernel.run(
        'rclpy.init()\n'
        'for _ in range(3):\n'
        '    rclpy.spin_once(talker)\n'
        'print(talker.count)\n'
        'while talker.count < 5:\n'
        '    rclpy.spin_once(talker, timeout_sec=0)\n'
        'print(talker.count)'
    )
    assert (counts.error, counts.text) == ('', '3\n5\n')
    future = kernel.run(
        'from std_srvs.srv import Trigger\n'
        'server = lab.spin(Node("server"))\n'
        'server.create_service(Trigger, "fire", lambda request, response: response)\n'
        'client = talker.create_client(Trigger, "fire")\n'
        'future = client.call_async(Trigger.Request())\n'
        'rclpy.spin_until_future_complete(talker, future)\n'
        'print(future.result())'
    )
    assert 'Trigger_Response' in future.text
    ended = kernel.run('rclpy.shutdown()\nprint(rclpy.ok())\nrclpy.init()\nprint(rclpy.ok())')
    assert (ended.error, ended.text) == ('', 'False\nTrue\n')


def test_pasted_threads_and_executors_work_and_end_with_the_kernel(kernel):
    kernel.run(SETUP + 'lab.start()')
    thread = kernel.run(
        TALKER.replace('lab.spin(Talker())', 'Talker()') + 'import rclpy, threading\n'
        'threading.Thread(target=rclpy.spin, args=(talker,), daemon=True).start()\n'
        'lab.wait_until(lambda: talker.count > 3)'
    )
    assert thread.error == ''
    executor = kernel.run(
        'from rclpy.executors import MultiThreadedExecutor\n'
        'ticks, other = [], Node("other")\n'
        'other.create_timer(0.01, lambda: ticks.append(1))\n'
        'executor = MultiThreadedExecutor()\n'
        'executor.add_node(other)\n'
        'threading.Thread(target=executor.spin, daemon=True).start()\n'
        'lab.wait_until(lambda: len(ticks) > 3)'
    )
    assert executor.error == ''
    assert kernel.shutdown() == 0
