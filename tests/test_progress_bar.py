"""The bar under a cell that takes longer than a moment."""

from __future__ import annotations

import re
from typing import Any

BAR = """
import labkit as lab
from labkit import progress_bar
progress_bar.SHOWN_AFTER_SEC = progress_bar.EVERY_SEC = 0.0
bar = progress_bar.ProgressBar('Checking')
bar.show(0.25, '<b> 7 s')
"""


def test_a_learner_sees_how_far_it_is(kernel: Any) -> None:
    (shown,) = kernel.run(BAR).outputs
    assert shown['data']['text/plain'] == 'Checking: <b> 7 s'
    assert 'Checking: &lt;b&gt; 7 s' in shown['data']['text/html']
    assert '<progress max="1" value="0.25"' in shown['data']['text/html']


def test_what_is_done_at_once_needs_no_bar(kernel: Any) -> None:
    kernel.run('from labkit.progress_bar import ProgressBar')
    assert kernel.run("ProgressBar('Checking').show(0.5, '')").outputs == []


def test_nobody_who_compares_outputs_sees_it(start_kernel: Any) -> None:
    kernel = start_kernel(LABKIT_HEADLESS='1')
    assert kernel.run(BAR).outputs == []


WAIT = """
import labkit as lab
from labkit import progress_bar
progress_bar.SHOWN_AFTER_SEC = progress_bar.EVERY_SEC = 0.0
ready = []
lab.wait_until(lambda: ready, timeout_sec=None)
"""


def test_a_cell_that_waits_says_so(kernel: Any) -> None:
    waits = kernel.start(WAIT)
    assert re.search(r'Waiting: \d+ s', kernel.wait_for_output(waits, 'Waiting'))
    kernel.interrupt()
    kernel.finish(waits)
    kernel.wait_until_gone(waits, 'Waiting')


def test_it_is_gone_though_the_stop_button_was_pressed_as_it_appeared(kernel: Any) -> None:
    code = (
        'from IPython.core import display_functions\n'
        'publish = display_functions.publish_display_data\n'
        'def publish_and_press(*args, **options):\n'
        '    display_functions.publish_display_data = publish\n'
        '    publish(*args, **options)\n'
        '    raise KeyboardInterrupt\n'
        'display_functions.publish_display_data = publish_and_press\n'
    )
    stopped = kernel.run(code + WAIT)
    assert stopped.error.startswith('KeyboardInterrupt')
    kernel.wait_for_output(stopped.msg_id, 'Waiting')
    kernel.wait_until_gone(stopped.msg_id, 'Waiting')


def test_a_limit_that_is_what_is_left_of_another_one_is_rounded(kernel: Any) -> None:
    kernel.run(WAIT.replace('lab.wait_until', '').replace('timeout_sec=None', ''))
    waits = kernel.start('lab.wait_until(lambda: ready, timeout_sec=49.94832)')
    kernel.wait_for_output(waits, ' of 49.9 s')
    kernel.interrupt()


def test_where_something_is_shown_no_bar_appears_beside_it(kernel: Any) -> None:
    kernel.run(BAR.replace("bar.show(0.25, '<b> 7 s')", ''))
    code = (
        'progress_bar.SHOWN_AFTER_SEC = 60.0\nprogress_bar.note_output()\nbar._due = 0\n'
        "bar.show(0.5, 'late')\nprogress_bar.SHOWN_AFTER_SEC = 0.0\nbar.show(0.5, 'now')\n"
        "other = progress_bar.ProgressBar('Waiting')\nother.show(0.5, 'inside of it')"
    )
    (shown,) = kernel.run(code).outputs
    assert shown['data']['text/plain'] == 'Checking: now'
