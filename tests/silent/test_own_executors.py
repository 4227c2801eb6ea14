"""Executors of the learner's own: who spins them, and what holds them up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Kernel

PRELUDE = (Path(__file__).parent / 'cases/prelude.py').read_text(encoding='utf-8')
MAKE = """
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
def own(name, kind=SingleThreadedExecutor):
    n, e = Node(name), kind()
    e.add_node(n)
    return n, e
def spin_in_thread(e):
    threading.Thread(target=e.spin, daemon=True).start()
def told(kind='life.unspun'):
    return any(f.kind.id == kind for f in watch.look())
"""


@pytest.fixture
def kernel(start_kernel: Callable[..., Kernel]) -> Kernel:
    kernel = start_kernel()
    for source in (PRELUDE, MAKE):
        ran = kernel.run(source)
        assert not ran.error, ran.traceback
    return kernel


def run(kernel: Kernel, source: str) -> str:
    ran = kernel.run(source)
    assert not ran.error, ran.traceback
    return ran.text


def test_an_executor_that_nobody_spins_is_told(kernel: Kernel) -> None:
    run(kernel, "n, e = own('lonely'); n.create_timer(0.1, heard)")
    assert '/lonely is in an executor that nobody spins' in run(kernel, 'look()')
    assert '/lonely is in an executor that nobody spins' in run(
        kernel, 'print(repr(lab.doctor()))'
    )
    run(kernel, 'spin_in_thread(e); lab.wait_until(lambda: not told())')
    assert '/lonely' in run(kernel, 'print(repr(lab.doctor()))')
    # The end of the spin, as by the stop button.
    run(kernel, 'e.shutdown(); lab.wait_until(told, timeout_sec=60)')


@pytest.mark.slow('lets time pass')
def test_a_loop_of_single_steps_spins(kernel: Kernel) -> None:
    run(kernel, "n, e = own('steps'); n.create_timer(0.1, heard)")
    run(
        kernel,
        'for _ in range(8): e.spin_once(timeout_sec=0.1); time.sleep(0.3)\nassert not told()',
    )
    run(kernel, 'free = threading.Event(); n.create_timer(0.01, free.wait); spin_in_thread(e)')
    # One that does not return is no executor that nobody spins.
    run(kernel, "lab.wait_until(lambda: told('life.held-executor'), timeout_sec=60)")
    assert run(kernel, 'print(told())') == 'False\n'


@pytest.mark.slow('lets time pass')
@pytest.mark.parametrize('kind', ['SingleThreadedExecutor', 'MultiThreadedExecutor'])
def test_a_call_that_waits_for_its_own_executor_is_told(kernel: Kernel, kind: str) -> None:
    run(
        kernel,
        "node('server').create_service(Trigger, 'work', lambda request, response: response)",
    )
    run(kernel, f"n, e = own('caller', {kind}); c = n.create_client(Trigger, 'work')")
    run(kernel, 'c.wait_for_service(); n.create_timer(0.1, lambda: c.call(Trigger.Request()))')
    run(
        kernel,
        "spin_in_thread(e); lab.wait_until(lambda: told('life.held-executor'), timeout_sec=60)",
    )
    text = run(kernel, 'look()')
    assert 'of /caller has been running for' in text
    assert 'It waits in call() of' in text and 'what ends that is one of them' in text
    assert 'of /caller has been running for' in run(kernel, 'print(repr(lab.doctor()))')


@pytest.mark.slow('lets time pass')
def test_who_waits_for_such_a_node_is_told_why(kernel: Kernel) -> None:
    run(
        kernel,
        "free = threading.Event(); n, e = own('stuck'); n.create_publisher(String, 'news', 10)",
    )
    run(kernel, 'n.create_timer(0.01, free.wait); spin_in_thread(e)')
    run(kernel, "lab.wait_until(lambda: told('life.held-executor'), timeout_sec=60)")
    ran = kernel.run("lab.wait_for_message('news', String, timeout_sec=1)")
    assert 'The callback wait of /stuck has been running for' in ran.traceback
