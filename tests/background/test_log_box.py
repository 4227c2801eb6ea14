"""Lines of nodes are counted and boxed, and stay a stream of plain text."""

from __future__ import annotations

STAGE = """
import asyncio
import labkit as lab
from labkit.background import compat
from rclpy.node import Node

told = []
display_under = compat.display_under

def listen(request, data, display_id, *, update):
    told.append(data['text/html'].rpartition('">')[2])
    display_under(request, data, display_id, update=update)

compat.display_under = listen

class Loud(Node):
    def __init__(self, times):
        super().__init__('loud')
        self.left = times
        self.timer = self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        self.left -= 1
        print(f'<b>{self.left}</b>\\n' * 10, end='')
        if not self.left:
            self.timer.cancel()

async def wait_for(words):
    while not told or words not in told[-1]:
        await asyncio.sleep(0.02)
"""


def test_lines_follow_their_box_and_the_last_count_stays(kernel):
    kernel.run(STAGE)
    cell = kernel.run('print("mine")\nloud = lab.spin(Loud(60))')
    words = '600 lines, the first 200 below. The last one: &lt;b&gt;0&lt;/b&gt;'
    assert not kernel.run(f'await wait_for({words!r})').error
    kernel.wait_for_output(cell.msg_id, '200 lines are shown')
    outputs = kernel.outputs_of(cell.msg_id)
    kinds = [output['output_type'] for output in outputs]
    assert kinds == ['stream', 'display_data', 'stream']
    assert outputs[0]['text'] == 'mine\n' and list(outputs[1]['data']) == ['text/html']
    lines = outputs[2]['text'].splitlines()
    assert lines[:200] == [f'<b>{left}</b>' for left in range(59, 39, -1) for _ in range(10)]


def test_a_dozen_lines_have_no_count(kernel):
    kernel.run(STAGE)
    cell = kernel.run('loud = lab.spin(Loud(1))')
    kernel.wait_for_output(cell.msg_id, '<b>0</b>\n' * 10)
    assert kernel.run('print(told)').text == "['</div>']\n"


def test_what_the_cell_itself_prints_has_no_box(kernel):
    kernel.run(STAGE + 'lab.start()')
    outputs = kernel.run('for number in range(50): print(number)').outputs
    assert [output['output_type'] for output in outputs] == ['stream']


def test_where_a_program_looks_on_there_is_none(start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run(STAGE)
    cell = kernel.run('loud = lab.spin(Loud(3))\nlab.wait_until(lambda: not loud.left)')
    assert [output['output_type'] for output in cell.outputs] == ['stream']
    assert cell.text.count('\n') == 30


def test_errors_stay_in_order_with_prints(kernel):
    kernel.run(STAGE)
    code = """
class Failing(Loud):
    def on_timer(self):
        self.timer.cancel()
        print('before')
        raise ValueError('after')

loud = lab.spin(Failing(1))
"""
    cell = kernel.run(code)
    text = kernel.wait_for_output(cell.msg_id, 'ValueError: after')
    assert text.index('before') < text.index('ValueError')
