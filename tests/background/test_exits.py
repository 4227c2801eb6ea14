"""Ways to end a process: in a callback they end its node, and elsewhere they are as always."""

from __future__ import annotations

import pytest

SETUP = """
import _thread, os, signal, sys, threading
import labkit as lab
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from labkit.background.runtime import runtime

def ends(name, spin, leave):
    node = Node(name)
    node.create_timer(0.01, leave)
    try:
        spin(node)
    except BaseException as error:
        if isinstance(error, LABERROR): raise
        print(name, repr(error))
    else:
        lab.wait_until(lambda: '/' + name in runtime.ended)

LABERROR = lab.LabError
def own(node):
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.spin()

MAIN = threading.main_thread().ident
other = lab.spin(Node('other'))
"""
INTERRUPT, EXIT = 'KeyboardInterrupt', 'SystemExit'
# A callback's way to end its program -> what it raises.
WAYS = {
    'sys.exit(3)': f'{EXIT}(3)',
    'exit()': f'{EXIT}()',
    'quit()': f'{EXIT}()',
    'os._exit(3)': f'{EXIT}(3)',
    'os.abort()': f'{EXIT}(134)',
    'signal.raise_signal(signal.SIGINT)': f'{INTERRUPT}()',
    'signal.raise_signal(signal.SIGTERM)': f'{EXIT}(143)',
    'os.kill(os.getpid(), signal.SIGINT)': f'{INTERRUPT}()',
    'os.kill(os.getpid(), signal.SIGTERM)': f'{EXIT}(143)',
    'os.kill(os.getpid(), 9)': f'{EXIT}(137)',
    'os.kill(0, signal.SIGTERM)': f'{EXIT}(143)',
    'os.kill(-os.getpgrp(), signal.SIGINT)': f'{INTERRUPT}()',
    'os.kill(os.getpid(), signal.SIGUSR1)': f'{EXIT}(138)',
    'os.kill(os.getpid(), signal.SIGSTOP)': f'{EXIT}(147)',
    'os.killpg(os.getpgrp(), signal.SIGTERM)': f'{EXIT}(143)',
    'os.killpg(0, 9)': f'{EXIT}(137)',
    'signal.pthread_kill(MAIN, signal.SIGTERM)': f'{EXIT}(143)',
    'signal.pthread_kill(MAIN, signal.SIGINT)': f'{INTERRUPT}()',
    'signal.alarm(1)': f'{EXIT}(142)',
    'signal.setitimer(signal.ITIMER_PROF, 0.1)': f'{EXIT}(155)',
    '_thread.interrupt_main()': f'{INTERRUPT}()',
    'os.execv("/bin/true", ["true"])': f"{EXIT}('os.exec of /bin/true')",
    'os.execle("/bin/true", "true", {})': f"{EXIT}('os.exec of /bin/true')",
}


@pytest.mark.parametrize('spin', ['lab.spin', 'rclpy.spin', 'own'])
def test_whatever_ends_a_process_ends_a_node_in_a_callback(kernel, spin):
    kernel.run(SETUP)
    for number, (way, error) in enumerate(WAYS.items()):
        result = kernel.run(f'ends("n{number}", {spin}, lambda: {way})')
        assert result.error == '', (way, result.traceback)
        if spin == 'lab.spin':
            kind, _, code = error.rstrip(')').partition('(')
            said = f'has ended its program ({kind}{": " * bool(code)}{code}).'
            assert said in kernel.wait_for_output(result.msg_id, 'alone.')
        else:
            assert result.text == f'n{number} {error}\n', way
    # The kernel is asked to end in a tenth of a second, and would say so before it does.
    assert kernel.run('print(get_ipython().exit_now, [e.name for e in runtime.nodes()])').text == (
        "False ['/other']\n"
    )


SERVICE = """
from std_srvs.srv import Trigger
class Served(Node):
    def __init__(self):
        super().__init__('served')
        self.create_service(Trigger, 'fire', self.on_fire)

    {be}def on_fire(self, request, response):
        sys.exit(3)

served = lab.spin(Served())
client = other.create_client(Trigger, 'fire')
future = client.call_async(Trigger.Request())
"""


@pytest.mark.parametrize('be', ['', 'async '])
def test_a_service_that_ends_its_program_ends_its_node(kernel, be):
    kernel.run(SETUP)
    cell = kernel.run(SERVICE.format(be=be) + 'lab.wait_until(lambda: runtime.ended)')
    assert cell.error == ''
    assert 'on_fire of /served has ended its program (SystemExit: 3).' in cell.text


def test_who_calls_a_service_that_ends_its_program_is_told(kernel):
    kernel.run(SETUP)
    kernel.run(SERVICE.format(be='').rpartition('client =')[0])
    said = kernel.run('%ros2 service call /fire std_srvs/srv/Trigger')
    assert '/fire gives no answer: /served has ended.' in said.text + said.traceback


def test_a_done_callback_that_ends_its_program_ends_its_node(kernel):
    kernel.run(SETUP)
    cell = kernel.run(
        SERVICE.format(be='').replace('sys.exit(3)', 'return response')
        + 'future.add_done_callback(lambda answered: sys.exit(4))\n'
        'lab.wait_until(lambda: "/other" in runtime.ended)'
    )
    assert cell.error == ''
    assert kernel.run('print([e.name for e in runtime.nodes()])').text == "['/served']\n"


@pytest.mark.parametrize('be', ['', 'async '])
@pytest.mark.parametrize('spin', ['lab', 'rclpy'])
def test_an_action_that_ends_its_program_ends_its_node(kernel, be, spin):
    kernel.run(SETUP)
    result = kernel.run(f"""
from rclpy.action import ActionClient, ActionServer
from test_msgs.action import Fibonacci
class Counter(Node):
    def __init__(self):
        super().__init__('counter')
        ActionServer(self, Fibonacci, 'count', self.execute)

    {be}def execute(self, handle):
        sys.exit(3)

client = ActionClient(other, Fibonacci, 'count')
node = Counter()
sent = client.send_goal_async(Fibonacci.Goal())
{spin}.spin(node)
lab.wait_until(lambda: runtime.ended)
""")
    said = 'execute of /counter has ended its program (SystemExit: 3).'
    assert said in result.text + result.traceback
    assert kernel.run('print([e.name for e in runtime.nodes()])').text == "['/other']\n"


def test_elsewhere_they_do_what_they_always_do(kernel):
    kernel.run(SETUP)
    own = kernel.run(
        'got = []\nsignal.signal(signal.SIGTERM, lambda *_: got.append(1))\n'
        'node = Node("own")\n'
        'node.create_timer(0.01, lambda: os.kill(os.getpid(), signal.SIGTERM))\n'
        'lab.spin(node)\nlab.wait_until(lambda: len(got) > 2)\nlab.remove(node)\n'
        'child = os.fork()\nif not child: os._exit(5)\n'
        'print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), os.kill(os.getpid(), 0))'
    )
    assert (own.error, own.text) == ('', '5 None\n')
    in_cell = kernel.run('os.kill(os.getpid(), signal.SIGINT)\nwhile True: pass')
    assert in_cell.error == 'KeyboardInterrupt: '
    undone = kernel.run(
        'from labkit.background.notebook_rclpy import uninstall\nuninstall()\n'
        'print(os._exit, hasattr(os.kill, "__wrapped__"))'
    )
    assert undone.text == '<built-in function _exit> False\n'
    kernel.run('exit()')
    kernel.process.wait(60)


def test_a_callback_may_ask_whether_its_process_is_alive(kernel):
    kernel.run(SETUP)
    result = kernel.run('ends("asking", rclpy.spin, lambda: sys.exit(os.kill(os.getpid(), 0)))')
    assert (result.error, result.text) == ('', 'asking SystemExit()\n')
    harmless = kernel.run(
        'signal.signal(signal.SIGUSR1, signal.SIG_IGN)\n'
        'sent = lambda: [os.kill(0, each) for each in (signal.SIGCHLD, signal.SIGUSR1)]\n'
        'ends("sending", rclpy.spin, lambda: sys.exit(f"{sent()} {signal.alarm(0)}"))'
    )
    assert (harmless.error, harmless.text) == ('', "sending SystemExit('[None, None] 0')\n")
