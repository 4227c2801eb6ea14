"""Whether a thread rests, or is at work, is seen however little time it gets."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from types import ModuleType
from typing import Any

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int16

from labkit.exercises.time.threads import OtherThreads


@contextmanager
def thread_that(works: Any, ends: Any) -> Iterator[Any]:
    thread = threading.Thread(target=works, daemon=True)
    thread.start()
    yield thread
    ends()
    thread.join()


def test_work_that_goes_from_thread_to_thread_is_waited_for_to_its_end() -> None:
    stages = [queue.SimpleQueue[int]() for _ in range(4)]

    def work(taken: queue.SimpleQueue[int], given: queue.SimpleQueue[int]) -> None:
        while (number := taken.get()) >= 0:
            sum(range(200_000))
            given.put(number + 1)
        given.put(number)

    for taken, given in pairwise(stages):
        threading.Thread(target=work, args=(taken, given), daemon=True).start()
    with OtherThreads() as threads:
        threads.settle()
        for number in range(30):
            stages[0].put(number)
            assert threads.settle()
            # Nobody waits here: it has come, or it has not.
            assert stages[-1].get_nowait() == number + 3
            assert not threads.settle()
    stages[0].put(-1)
    assert stages[-1].get() == -1


def test_a_thread_that_never_rests_is_waited_for_once() -> None:
    done = threading.Event()

    def work() -> None:
        while not done.is_set():
            pass

    with thread_that(work, done.set), OtherThreads() as threads:
        assert threads.settle()
        assert not threads.settle()


def test_one_that_waits_for_this_thread_rests() -> None:
    lock, done = threading.Lock(), threading.Event()

    def work() -> None:
        with lock:
            done.wait()

    lock.acquire()
    with thread_that(work, done.set), OtherThreads() as threads:
        threads.settle()
        assert not threads.settle()
        # It was not given up: it is seen as soon as it runs.
        lock.release()
        assert threads.settle()


def test_an_executor_of_the_learners_own_is_waited_for(lab: ModuleType) -> None:
    node, executor, heard = Node('own'), SingleThreadedExecutor(), list[int]()

    def on_number(msg: Int16) -> None:
        sum(range(200_000))
        heard.append(msg.data)

    node.create_subscription(Int16, 'numbers', on_number, 10)
    publisher = node.create_publisher(Int16, 'numbers', 10)
    executor.add_node(node)
    with thread_that(executor.spin, executor.shutdown), OtherThreads() as threads:
        threads.settle()
        for number in range(10):
            publisher.publish(Int16(data=number))
            assert threads.settle()
            assert heard[-1] == number


def test_threads_of_the_notebook_itself_are_not_waited_for(kernel):
    code = """
import threading
from labkit.exercises.time.threads import OtherThreads
lab.start()
with OtherThreads() as threads:
    threads.settle()
    print(len(threading.enumerate()) > 5, list(threads._threads()))
"""
    kernel.run('import labkit as lab')
    assert kernel.run(code).text == 'True []\n'
