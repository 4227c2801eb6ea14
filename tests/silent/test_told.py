"""The classics: each is told under the cell that made it, once, and is gone when it is mended."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from labkit.silent.parameter_faults import UNDECLARED
from tests.conftest import Kernel

PRELUDE = """
import time
import labkit as lab
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
lab.start()

class Cruiser(Node):
    def __init__(self, **more):
        super().__init__('cruiser', **more)
        self.declare_parameter('speed', 1.0)

class Talker(Node):
    def __init__(self, **more):
        super().__init__('talker', **more)
        self.publisher = self.create_publisher(String, 'chatter', 10)

class Sleeper(Node):
    def __init__(self):
        super().__init__('sleeper')
        self.create_timer(1.0, self.slow)
        self.create_timer(0.5, self.quick)

    def slow(self):
        time.sleep(1.5)

    def quick(self):
        pass
"""
# A publisher and a subscription that do not match.
FAR_AWAY = """
import rclpy
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String
rclpy.init()
node, other = rclpy.create_node('far'), rclpy.create_node('away')
node.create_publisher(String, 'far', qos_profile_sensor_data)
other.create_subscription(String, 'far', print, 10)
rclpy.spin(node)
"""
CLASSICS = {
    'params-file': (
        "open('p.yaml', 'w').write('cruizer: {ros__parameters: {speed: 0.5}}')\n"
        "c = lab.spin(Cruiser(cli_args=['--ros-args', '--params-file', 'p.yaml']))",
        'p.yaml has parameters for /cruizer, but the node is called /cruiser: it takes none',
    ),
    'override': (
        "c = lab.spin(Cruiser(parameter_overrides=[Parameter('sped', value=0.5)]))",
        "/cruiser is given the parameter 'sped', which it never declares: it declares speed.\n"
        "  → Did you mean 'speed'?",
    ),
    'remap': (
        "c = lab.spin(Talker(cli_args=['--ros-args', '-r', '/chater:=/other']))",
        'The rule /chater:=/other matches no name of /talker, which has /chatter. The nearest is '
        '/chatter.',
    ),
    'clock': (
        "c = lab.spin(Talker(parameter_overrides=[Parameter('use_sim_time', value=True)]))",
        '/talker uses simulated time (use_sim_time) and waits for /clock, which nobody publishes',
    ),
    'sleep': (
        'c = lab.spin(Sleeper())',
        's; meanwhile nothing else runs.',
    ),
    'namespace': (
        "d = lab.spin(Talker(namespace='robot1')); c = lab.spin(Node('listener'))\n"
        "c.create_subscription(String, '/chatter', print, 10);",
        '/listener waits on /chatter, where nobody publishes; /robot1/chatter has a publisher of '
        'that type, /robot1/talker, which nobody hears.',
    ),
}


@pytest.fixture
def notebook(start_kernel: Callable[..., Kernel]) -> Kernel:
    kernel = start_kernel()
    assert not kernel.run(PRELUDE).error
    return kernel


@pytest.mark.slow('each fault, in a kernel of its own')
def test_each_is_told_under_its_cell_and_gone_when_it_is_mended(notebook: Kernel) -> None:
    for name, (code, sentence) in CLASSICS.items():
        made = notebook.run(code)
        assert not made.error, made.traceback
        shown = notebook.wait_for_output(made.msg_id, sentence)
        assert shown.count('⚠') == 1, (name, shown)
        assert not notebook.run('lab.remove(c)').error
        notebook.wait_until_gone(made.msg_id, sentence)
        notebook.run('lab.stop()\nlab.start()')


@pytest.mark.slow('waits in real time')
def test_a_rate_that_nobody_spins_is_told_while_it_hangs(notebook: Kernel) -> None:
    cell = notebook.start("n = Node('sleepy')\nn.create_rate(10).sleep()")
    said = 'sleep() of a rate waits for /sleepy, which nobody spins: for ever.'
    notebook.wait_for_output(cell, said)
    notebook.interrupt()
    notebook.finish(cell)
    notebook.wait_until_gone(cell, said)


@pytest.mark.slow('waits in real time')
@pytest.mark.parametrize(
    'body', ['while True:\n            time.sleep(0.1)', 'while True:\n            pass']
)
def test_what_a_cell_waits_for_is_told_while_a_node_is_made_without_end(
    notebook: Kernel, body: str
) -> None:
    lines = (
        'class Endless(Node):',
        '    def __init__(self):',
        "        super().__init__('endless')",
        f'        {body}',
        'lab.spin(Endless())',
    )
    cell = notebook.start('\n'.join(lines))
    said = 'This cell waits for Endless.__init__, which is in line '
    shown = notebook.wait_for_output(cell, said)
    assert ' of Cell In[' in shown and 'The stop button ends it.' in shown
    notebook.interrupt()
    notebook.finish(cell)
    notebook.wait_until_gone(cell, said)


STUCK = """
import threading
free = threading.Event()
stuck = lab.spin(Node('stuck'))
stuck.create_timer(0.01, lambda: free.wait())
"""


@pytest.mark.slow('waits in real time')
def test_a_stuck_callback_is_told_for_as_long_as_it_keeps_all_others(notebook: Kernel) -> None:
    said = '/stuck has been running for'  # after its end: of an earlier /stuck
    made = notebook.run(STUCK)
    shown = notebook.wait_for_output(made.msg_id, said)
    assert 'neither the stop button nor lab.remove(node) ends a callback' in shown
    # The cell is mended and run again: the callback of the earlier node runs on.
    again = notebook.run("stuck = lab.spin(Node('stuck'))")
    notebook.wait_for_output(again.msg_id, said)
    notebook.run('lab.remove(stuck)')
    seen = notebook.run(
        'from labkit.silent.watch import watch\nprint([one.kind.id for one in watch.look()])'
    )
    assert 'time.stuck-callback' in seen.text
    notebook.run('free.set()')
    notebook.wait_until_gone(made.msg_id, said)
    notebook.wait_until_gone(again.msg_id, said)


def test_it_is_told_wherever_one_looks(notebook: Kernel) -> None:
    notebook.run('t = Twist(); t.angular.z = 90.0')
    notebook.run("p = lab.spin(Node('driver')).create_publisher(Twist, 'cmd_vel', 10)")
    notebook.run('p.publish(t)')
    said = 'angular.z is 90, 14.3 turns a second'
    driver = 'from labkit.background.runtime import runtime\nruntime.nodes()[0].node'
    for code in (driver, 'print(lab.graph(live=False))', 'print(lab.doctor())'):
        assert said in ' '.join(notebook.run(code).text.split()), code
    assert said in notebook.run('%ros2 doctor').text
    # In the picture, the node and its topic have a sign.
    signs = "lab.graph(live=False)._repr_mimebundle_()['image/svg+xml'].count('class=\"sign\"')"
    assert notebook.run(f'print({signs})').text.strip() == '2'
    view = "from labkit.views.monitor import _faults\nprint(*_faults('/cmd_vel', hears=True))"
    notebook.run('from labkit.silent.watch import watch\nlab.wait_until(lambda: watch.seen)')
    assert said in notebook.run(view).text
    notebook.run('lab.stop()')
    assert 'All is well' in notebook.run('print(lab.doctor())').text


TWO_PARENTS = """
from geometry_msgs.msg import TransformStamped
from tf2_ros import TransformBroadcaster

def tell(name, parent):
    node = lab.spin(Node(name))
    broadcaster = TransformBroadcaster(node)
    def tick():
        t = TransformStamped(child_frame_id='base')
        t.header.frame_id, t.header.stamp = parent, node.get_clock().now().to_msg()
        broadcaster.sendTransform(t)
    node.create_timer(0.02, tick)
    return node

"""


@pytest.mark.timeout(900)  # a first build of the type
def test_a_frame_with_two_parents_is_told_wherever_one_looks(notebook: Kernel) -> None:
    notebook.run(TWO_PARENTS, timeout=800)
    notebook.run("a = tell('a', 'odom')")
    made = notebook.run("b = tell('b', 'map')")
    notebook.run('from labkit.silent.watch import watch\nlab.wait_until(lambda: watch.seen)')
    said = '/a says that base is in odom, and /b that it is in map'
    view = "from labkit.views.monitor import _faults\nprint(*_faults('/tf', hears=True))"
    for code in ('a', 'b', 'print(lab.graph(live=False))', 'print(lab.doctor())', view):
        assert said in ' '.join(notebook.run(code).text.split()), code
    assert said in notebook.run('%ros2 doctor').text
    # The two nodes and the topic have a sign.
    signs = "lab.graph(live=False)._repr_mimebundle_()['image/svg+xml'].count('class=\"sign\"')"
    assert notebook.run(f'print({signs})').text.strip() == '3'
    assert not notebook.run('lab.remove(b)').error
    notebook.wait_until_gone(made.msg_id, said)
    assert 'All is well' in notebook.run('print(lab.doctor())').text


@pytest.mark.slow('waits in real time')
def test_the_doctor_hides_no_fault_behind_another(notebook: Kernel) -> None:
    made = notebook.run("""
from rclpy.qos import qos_profile_sensor_data
sonar = lab.spin(Node('sonar')).create_publisher(String, 'range', qos_profile_sensor_data)
lab.spin(Node('display')).create_subscription(String, 'range', print, 10)
t = Twist(); t.angular.z = 90.0
p = lab.spin(Node('driver')).create_publisher(Twist, 'cmd_vel', 10)
p.publish(t)
""")
    assert not made.error, made.traceback
    said = ' '.join(notebook.run('print(lab.doctor())').text.split())
    assert said.count('/display does not hear /sonar') == 1, said
    assert 'angular.z is 90, 14.3 turns a second' in said


# More messages at once than a queue holds, all of which have come and gone.
BURST = [
    """
from labkit.background.runtime import runtime

heard = []
ear = lab.spin(Node('ear'))
ear.create_subscription(String, 'burst', heard.append, 2)
mouth = ear.create_publisher(String, 'burst', 10)
""",
    """
with runtime.executor.between_callbacks():
    for number in range(9):
        mouth.publish(String(data=str(number)))
lab.wait_until(lambda: len(heard) == 2)
""",
]
OVERRUN = """
ear.create_timer(0.05, lambda: time.sleep(0.25))
lab.wait_until(lambda: [3] == [len(times) for times in runtime.entry_of(ear).took.values()])
"""


@pytest.mark.slow('waits in real time')
def test_a_burst_right_after_the_subscription_was_made_is_told(notebook: Kernel) -> None:
    made = notebook.run(''.join(BURST))
    assert not made.error, made.traceback
    shown = notebook.wait_for_output(made.msg_id, 'more came at a time than its queue holds, 2.')
    assert '/ear has missed' in shown


def test_it_is_the_last_output_of_a_cell_where_outputs_are_compared(
    start_kernel: Callable[..., Kernel],
) -> None:
    kernel = start_kernel(LABKIT_HEADLESS='1')
    assert not kernel.run(PRELUDE).error
    code, sentence = CLASSICS['override']
    assert kernel.run(f"print('before')\n{code}\nprint('behind')").text == (
        f'before\nbehind\n⚠ {sentence} {UNDECLARED.todo}\n'
    )
    assert not kernel.run('lab.graph(live=False);').text  # once
    assert not kernel.run('lab.remove(c)').text
    assert sentence in kernel.run(code).text
    # What is mended in the same cell is not shown, and no thread looks.
    assert not kernel.run(f'{code}\nlab.remove(c)').text
    # Nor is a full queue, or a late timer: a busy machine makes them.
    for cell in (*BURST, OVERRUN):
        ran = kernel.run(cell)
        assert not ran.error, ran.traceback
        assert not ran.text
    threads = kernel.run('import threading\nprint(*(t.name for t in threading.enumerate()))').text
    assert 'labkit watch' not in threads


@pytest.mark.slow('starts another process')
def test_what_two_nodes_of_another_process_miss_is_told_under_no_cell(
    start_kernel: Callable[..., Kernel],
) -> None:
    kernel = start_kernel(LABKIT_HEADLESS='1', ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    assert not kernel.run(PRELUDE).error
    ran = kernel.run(f"""
import subprocess, sys
# What it says itself of QoS comes whenever it comes.
child = subprocess.Popen([sys.executable, '-c', {FAR_AWAY!r}], stderr=subprocess.DEVNULL)
helper = lab.spin(Node('looks_on'))
lab.wait_until(
    lambda: helper.count_publishers('far') and helper.count_subscribers('far'), timeout_sec=30
)
""")
    again = kernel.run("print('next')")
    kernel.run('child.kill()\nchild.wait()')
    assert not ran.error, ran.traceback
    assert not ran.text
    assert again.text == 'next\n'


@pytest.mark.slow('waits in real time')
def test_a_node_whose_name_comes_after_its_publisher_is_seen(
    start_kernel: Callable[..., Kernel],
) -> None:
    kernel = start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    prelude = Path(__file__).parent / 'cases' / 'prelude.py'
    assert not kernel.run(prelude.read_text(encoding='utf-8')).error
    kernel.run("robot, told = deaf('robot', 'cmd_vel', TwistStamped), []")
    kernel.run("""
def look_until(stop):
    while not stop.is_set():
        watch.look()

def drive(name):
    stop = threading.Event()
    thread = threading.Thread(target=look_until, args=[stop])
    thread.start()
    ORIGINALS['create_publisher'](other_process(name), Twist, 'cmd_vel', 10)
    ends = lambda: runtime.helper.get_publishers_info_by_topic('/cmd_vel')
    lab.wait_until(lambda: name in [end.node_name for end in ends()], timeout_sec=20)
    stop.set()
    thread.join()
    told.append(any(f'/{name}' in fault.nodes for fault in watch.look()))
""")
    made = kernel.run("for number in range(4):\n    drive(f'driver_{number}')")
    assert not made.error, made.traceback
    assert kernel.run('print(*told)').text == 'True True True True\n'


LOST = """
from std_srvs.srv import SetBool, Trigger
from rclpy.context import Context
from labkit.background.runtime import runtime
there = Context()
rclpy.init(context=there, domain_id=runtime.domain_id)  # as another process is
far = Node('a_client', context=there)
right = far.create_client(SetBool, 'lamp')
server = Node('server', context=there).create_service(SetBool, 'lamp', print)
caller = lab.spin(Node('caller'))
client = caller.create_client(Trigger, 'lamp')
lab.wait_until(lambda: len(runtime.helper.get_node_names()) > 3, timeout_sec=20)
client.call_async(Trigger.Request());
"""


@pytest.mark.slow('two participants find each other')
def test_of_two_clients_the_one_with_the_wrong_type_is_told(
    start_kernel: Callable[..., Kernel],
) -> None:
    kernel = start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    assert not kernel.run(PRELUDE).error
    made = kernel.run(LOST)
    assert not made.error, made.traceback
    shown = kernel.wait_for_output(made.msg_id, '/caller never finds the server /server.')
    # There is a server, so it would be wrong that nobody offers the service.
    assert shown.count('⚠') == 1 and '/a_client' not in shown
