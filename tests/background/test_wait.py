"""The one wait: it looks when something has happened, and the stop button ends it."""

import threading

import pytest

from labkit.background import wait


def test_the_last_answer_is_returned_whether_time_is_over_or_not():
    answers = iter(['', '', 'here'])
    assert wait.wait_for(lambda: next(answers), None) == 'here'
    assert wait.wait_for(lambda: '', 0.0) == ''
    assert wait.wait_for(lambda: [], 0.05) == []


def test_it_looks_once_when_it_is_not_to_wait():
    looks: list[None] = []
    wait.wait_for(lambda: looks.append(None), 0.0)
    wait.wait_for(lambda: looks.append(None), -1.0)
    assert len(looks) == 2


def test_news_from_any_thread_wakes_all_that_wait(monkeypatch):
    monkeypatch.setattr(wait, 'POLL_SEC', 3600.0)
    seen: list[None] = []
    waiting = threading.Semaphore(0)

    def look():
        waiting.release()
        return seen

    threads = [threading.Thread(target=wait.wait_for, args=(look, None)) for _ in range(2)]
    for thread in threads:
        thread.start()
        waiting.acquire()
    seen.append(None)
    wait.wake()
    for thread in threads:
        thread.join()


def test_what_happens_during_a_look_asks_for_another_one(monkeypatch):
    monkeypatch.setattr(wait, 'POLL_SEC', 3600.0)
    looks: list[None] = []

    def look():
        looks.append(None)
        wait.wake()
        return len(looks) == 3

    assert wait.wait_for(look, None)


def test_what_a_look_raises_ends_the_wait_and_leaves_nothing():
    with pytest.raises(ZeroDivisionError):
        wait.wait_for(lambda: 1 / 0, None)
    assert wait._sleeping == []


def test_a_callback_wakes_it(script):
    result = script("""
import labkit as lab
from labkit.background import wait
from rclpy.node import Node

wait.POLL_SEC = 3600.0
count = 0

class Ticker(Node):
    def __init__(self):
        super().__init__('ticker')
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        global count
        count += 1

lab.spin(Ticker())
print(wait.wait_for(lambda: count >= 3, None))
lab.wait_until(lambda: count >= 6)
print(count >= 6)
""")
    assert result.stdout.split() == ['True', 'True']


def test_the_stop_button_ends_it_and_leaves_nothing(kernel):
    kernel.run('import threading\nfrom labkit.background import wait')
    # As long as there is a poll, and where nothing but the alarm ends it.
    for poll_sec in ('wait.POLL_SEC', '3600.0'):
        cell = kernel.start(
            f'wait.POLL_SEC = {poll_sec}\nwait.wait_for(lambda: print("waits") or False, None)'
        )
        kernel.wait_for_output(cell, 'waits')
        kernel.interrupt()
        assert kernel.finish(cell).error.startswith('KeyboardInterrupt')
    assert kernel.run('print(wait._sleeping)').text == '[]\n'
