"""A cell is run again: the new node is in the graph under its own name."""

from __future__ import annotations

import pytest

TALKER = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.02, self.on_timer)
        self.count = 0

    def on_timer(self):
        self.publisher.publish(String(data='again'))
        self.count += 1

seen = set()
"""
AGAIN = """
talker = lab.spin(Talker())
lab.wait_until(lambda: talker.count >= 1, timeout_sec=30)
seen |= {info.node_name for info in talker.get_publishers_info_by_topic('/chatter')}
"""


def test_a_node_that_was_started_again_keeps_its_name_in_the_graph(kernel):
    kernel.run(TALKER)
    for _ in range(10):
        result = kernel.run(AGAIN)
        assert not result.error, result.traceback
    assert kernel.run('print(seen)').text == "{'talker'}\n"


def test_it_keeps_its_name_while_somebody_still_holds_the_one_before(kernel):
    code = f"""
{TALKER}
import threading, time
from labkit.background.runtime import runtime

def hold(handle, held):
    # As an executor does that waits: it lets go a moment after all else of the node has gone.
    with handle:
        held.set()
        while runtime.helper.count_publishers('/chatter'):
            time.sleep(0.001)
        time.sleep(0.1)

for _ in range(5):
    talker = lab.spin(Talker())
    lab.wait_until(lambda: talker.count >= 1, timeout_sec=30)
    held = threading.Event()
    threading.Thread(target=hold, args=(talker.handle, held)).start()
    held.wait()
    lab.remove(talker)
talker = lab.spin(Talker())
for thread in threading.enumerate():
    if thread.name.endswith('(hold)'):
        thread.join()
print([info.node_name for info in talker.get_publishers_info_by_topic('/chatter')])
"""
    assert kernel.run(code).text == "['talker']\n"


@pytest.mark.slow('waits for what does not return')
def test_removing_a_node_whose_callback_does_not_return_ends_soon(kernel):
    kernel.run(TALKER)
    code = """
import threading
let_go, reached = threading.Event(), threading.Event()
slow = lab.spin(Node('slow'))
slow.create_timer(0.01, lambda: (reached.set(), let_go.wait()))
reached.wait()
lab.remove('slow')
let_go.set()
print('removed')
"""
    assert 'removed' in kernel.run(code).text


def test_a_wrong_node_name_is_reported_once(kernel):
    result = kernel.run(
        "import labkit as lab\nlab.start()\nimport rclpy\nrclpy.create_node('a b')"
    )
    assert result.error.startswith('InvalidNodeNameException')
    assert 'Warning' not in result.text
