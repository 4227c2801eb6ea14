"""The doctor: its table, and the nodes and callbacks that get a red line."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Iterator

import pytest
from visits import NAMES, Visit, look, visit

from labkit.background import domains
from labkit.checkup.found import Found
from labkit.checkup.report import Line, Report

OTHER = """
import sys
import rclpy
rclpy.init()
node = rclpy.create_node('talker')
print('ready', flush=True)
sys.stdin.read()
"""


@pytest.fixture
def domain_id() -> Iterator[str]:
    """Give a domain that no other test or notebook has."""
    claim = domains.claim_domain()
    yield str(claim.domain_id)
    claim.close()


# --- A healthy machine ---------------------------------------------------------------------------


def test_healthy_in_a_terminal(lab_env: dict[str, str]) -> None:
    seen = visit(lab_env)
    assert (seen.red, seen.exit_code, seen.noise) == ({}, 0, '')
    assert seen.names == NAMES
    assert seen.text.endswith('\nAll is well.\n')


def test_healthy_in_a_notebook_before_and_after_ros_is_started(kernel) -> None:
    kernel.run('import labkit as lab\nfrom rclpy.node import Node')
    for code in ('', 'lab.start()', 'lab.spin(Node("talker"))', 'lab.stop()'):
        assert not kernel.run(code).error
        seen = look(kernel)
        assert (seen.red, seen.exit_code) == ({}, 0), code
    # Threads of what has ended may still end; the doctor leaves none of its own.
    kernel.run('import threading\nbefore = set(threading.enumerate())\nlab.doctor()')
    assert kernel.run('print(set(threading.enumerate()) - before)').text == 'set()\n'


@pytest.mark.slow('the doctor looks for other processes')
def test_headless_report_is_the_same_on_any_healthy_machine(
    start_kernel: Callable[..., object], lab_env: dict[str, str], domain_id: str
) -> None:
    kernel = start_kernel(LABKIT_HEADLESS='1', ROS_DOMAIN_ID=domain_id)
    cell = 'lab.doctor()'
    kernel.run('import labkit as lab\nfrom rclpy.node import Node')
    first = kernel.run(cell).outputs[0]['data']
    kernel.run('lab.spin(Node("talker"))')
    again = kernel.run(cell).outputs[0]['data']
    assert again == first
    assert not re.search(r'[0-9/]', first['text/plain'].replace('ROS 2', ''))
    elsewhere = visit({**lab_env, 'LABKIT_HEADLESS': '1', 'ROS_AUTOMATIC_DISCOVERY_RANGE': ''})
    assert elsewhere.text.strip() == first['text/plain']


@pytest.mark.slow('the doctor looks for other processes')
def test_headless_doctor_lets_no_output_of_callbacks_through(
    start_kernel: Callable[..., object],
) -> None:
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run('import labkit as lab\nfrom rclpy.node import Node')
    cell = kernel.run(
        'node = lab.spin(Node("loud"))\n'
        'timer = node.create_timer(0.001, lambda: print("loud"))\n'
        'from labkit.background.runtime import runtime\n'
        'before = runtime.entry_of(node).callbacks\n'
        'report = lab.doctor()\n'
        'lab.stop()'
    )
    assert cell.text == ''


# --- The report itself ---------------------------------------------------------------------------


def test_report_says_sign_and_word_and_what_to_do() -> None:
    report = Report((Line('Disk', True, '3 GB'), Line('Nodes', False, 'lost', 'find it')))
    assert not report.ok
    assert repr(report) == (
        '✔ good   Disk   3 GB\n✘ wrong  Nodes  lost\n                → find it\n\n'
        '1 of 2 lines is wrong.'
    )
    assert 'find it' in repr(Report(report.lines, brief=True))
    assert '3 GB' not in repr(Report(report.lines, brief=True))


def test_each_of_several_faults_has_what_to_do_below_it() -> None:
    found = Found([('a is deaf', 'mend a'), ('b is lost', 'find b'), ('c is deaf', 'mend a')])
    line = Line('Nodes', False, found.message, found.todo, found.lines)
    assert repr(Report((line, Line('Disk', False, 'full', 'delete')))) == (
        '✘ wrong  Nodes  a is deaf\n                c is deaf\n                → mend a\n'
        '                b is lost\n                → find b\n✘ wrong  Disk   full\n'
        '                → delete\n\n2 of 2 lines are wrong. Begin with the first of them.'
    )
    page = Report((line,))._repr_html_()
    assert 'a is deaf<br>c is deaf<br>→ mend a<br><br>b is lost<br>→ find b</td>' in page


def test_report_is_escaped_in_a_notebook() -> None:
    nasty = '<img src=x onerror=alert(1)>'
    page = Report((Line('Nodes', False, nasty, nasty), Line('Domain', True, nasty)))._repr_html_()
    assert '<img' not in page
    assert page.count('&lt;img') == 3
    assert 'wrong' in page and 'good' in page


def test_a_check_that_fails_is_a_line_and_not_the_end(script: Callable[..., object]) -> None:
    result = script(
        'import os\nimport labkit as lab\n'
        'folder = os.path.join(os.getcwd(), "gone")\n'
        'os.mkdir(folder)\nos.chdir(folder)\nos.rmdir(folder)\n'
        'report = lab.doctor()\nprint(report)\n'
        'print([line.name for line in report.lines if not line.ok])'
    )
    assert result.exit_code == 0, result.stderr
    assert 'This could not be looked at: FileNotFoundError' in result.stdout
    assert result.stdout.endswith("['Disk']\n")
    assert Visit(0, result.stdout).names == NAMES


# --- Nodes, topics and callbacks -----------------------------------------------------------------

SETUP = """
import labkit as lab
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_msgs.msg import String
"""
TALKER = """
class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.count += 1

talker = lab.spin(Talker())
"""


def run_as_cell(kernel, cell_id: str, code: str) -> None:
    """Run code as JupyterLab does: it says which cell of the notebook it is."""
    client = kernel._client
    message = client.session.msg(
        'execute_request',
        {'code': code, 'silent': False, 'store_history': True, 'user_expressions': {}},
        metadata={'cellId': cell_id},
    )
    client.shell_channel.send(message)
    assert not kernel.finish(message['header']['msg_id']).error


def test_a_robot_that_its_timeout_has_stopped_is_no_fault_and_told(kernel) -> None:
    kernel.run(SETUP)
    kernel.run('robot = lab.spin(lab.Turtlebot(command_timeout=0.2))')
    assert 'stands' not in kernel.run('print(lab.doctor())').text
    kernel.run(
        '%ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist "{linear: {x: 0.2}}"\n'
        'lab.wait_until(lambda: robot.timed_out)'
    )
    lines = ' '.join(kernel.run('print(lab.doctor())').text.split())
    assert '/turtlebot. /turtlebot stands: no command for 0.2 s; its time limit' in lines
    assert look(kernel).exit_code == 0
    # It is told beside a fault, too.
    kernel.run('idle = Node("idle")')
    nodes = look(kernel).red['Nodes']
    assert '/idle was made' in nodes and '/turtlebot stands: no command' in nodes


def test_nodes_that_nobody_spins(kernel) -> None:
    kernel.run(SETUP)
    kernel.run('lab.start()\nfor _ in range(2):\n    node = Node("idle")\nhidden = Node("_mine")')
    seen = look(kernel)
    assert seen.exit_code == 1
    assert set(seen.red) == {'Nodes'}
    assert '/idle was made, but nobody spins it' in seen.red['Nodes']
    kernel.run('lab.spin(node)')
    assert look(kernel).exit_code == 0
    kernel.run('lab.remove(node)\nnode = Node("idle")')
    assert look(kernel).exit_code == 1
    kernel.run('lab.remove(node)')
    assert look(kernel).exit_code == 0


@pytest.mark.slow('the doctor looks for other processes')
def test_node_that_an_edited_cell_left_behind(kernel) -> None:
    kernel.run(SETUP)
    run_as_cell(kernel, 'start', 'lab.spin(Node("talker"))')
    run_as_cell(kernel, 'other', 'lab.spin(Node("other"))')
    run_as_cell(kernel, 'start', 'lab.spin(Node("talker"))')
    assert look(kernel).exit_code == 0
    run_as_cell(kernel, 'start', 'lab.spin(Node("speaker"))')
    seen = look(kernel)
    assert seen.exit_code == 1
    assert '/talker still runs, though its cell starts /speaker now' in seen.red['Nodes']
    kernel.run('lab.remove("talker")')
    assert look(kernel).exit_code == 0


def test_node_of_an_earlier_version_of_its_class(kernel) -> None:
    kernel.run(SETUP + TALKER)
    assert look(kernel).exit_code == 0
    kernel.run(TALKER.replace("'talker'", "'speaker'"))
    seen = look(kernel)
    assert seen.exit_code == 1
    assert '/talker runs an earlier version of its class Talker' in seen.red['Nodes']
    assert "lab.remove('/talker')" in seen.red['Nodes']
    kernel.run('lab.remove("/talker")')
    assert look(kernel).exit_code == 0


@pytest.mark.slow('starts another process')
def test_double_in_another_process(start_kernel: Callable[..., object], domain_id: str) -> None:
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': domain_id}
    kernel, other = start_kernel(**env), start_kernel(**env)
    for each in (kernel, other):
        assert not each.run(SETUP + TALKER).error
    met = kernel.run(
        'lab.wait_until(lambda: "/talker" in runtime.foreign_nodes(), timeout_sec=60)'
    )
    assert not met.error
    seen = look(kernel)
    assert seen.exit_code == 1
    assert 'Another process has a node called /talker, too.' in seen.red['Nodes']
    other.run('lab.stop()')
    gone = kernel.run('lab.wait_until(lambda: not runtime.foreign_nodes(), timeout_sec=60)')
    assert not gone.error
    assert look(kernel).exit_code == 0


@pytest.mark.slow('the doctor looks for other processes')
def test_domain_that_was_changed_after_the_start(kernel, domain_id: str) -> None:
    kernel.run(SETUP + f'import os\nlab.start()\nos.environ["ROS_DOMAIN_ID"] = "{domain_id}"')
    seen = look(kernel)
    assert seen.exit_code == 1
    assert f"but ROS_DOMAIN_ID is '{domain_id}' now" in seen.red['Domain']
    kernel.run('lab.stop()\nlab.start()')
    assert look(kernel).exit_code == 0


@pytest.mark.slow('the doctor looks for other processes')
def test_a_program_in_another_domain_is_named(kernel, lab_env: dict[str, str]) -> None:
    claim = domains.claim_domain(shared=True)  # not listed as that of a notebook
    env = {**lab_env, 'ROS_DOMAIN_ID': str(claim.domain_id)}
    env['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    kernel.run(f'{SETUP}lab.start()')

    def is_named() -> bool:
        said = ' '.join(kernel.run('print(lab.doctor())').text.split())
        (found,) = re.findall(r'Domain (.*?) ✔', said)
        return bool(re.search(rf'programs of yours in .*\b{claim.domain_id}\b', found))

    assert not is_named()
    command = [sys.executable, '-c', OTHER]
    other = subprocess.Popen(command, env=env, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert other.stdout.readline() == b'ready\n'
    assert is_named()
    other.communicate()
    assert not is_named()
    claim.close()


def test_pair_that_does_not_match_until_one_end_is_mended(kernel) -> None:
    kernel.run(SETUP + 'from rclpy.qos import qos_profile_sensor_data')
    kernel.run('sonar = lab.spin(Node("sonar"))\npilot = lab.spin(Node("pilot"))')
    kernel.run('sonar.create_publisher(String, "range", qos_profile_sensor_data)')
    hears = 'ear = pilot.create_subscription(String, "range", print, {})'
    kernel.run(hears.format(10))
    seen = look(kernel)
    assert seen.exit_code == 1
    assert set(seen.red) == {'Topics'}
    assert (
        'On /range, /pilot does not hear /sonar: best effort publisher and reliable subscription. '
        '→ Give the subscription of /pilot reliability BEST_EFFORT, or the publisher of /sonar '
        'RELIABLE.' in seen.red['Topics']
    )
    kernel.run('pilot.destroy_subscription(ear)\n' + hears.format('qos_profile_sensor_data'))
    assert look(kernel).exit_code == 0


def test_error_in_a_callback_until_it_is_mended(kernel) -> None:
    kernel.run(SETUP + TALKER.replace('self.count += 1', 'self.count += "one"'))
    kernel.run(
        'lab.wait_until(lambda: runtime.console.errors[0:] and '
        'runtime.console.errors[0].count >= 3)'
    )
    seen = look(kernel)
    assert seen.exit_code == 1
    assert set(seen.red) == {'Callbacks'}
    assert re.search(r'on_timer of /talker failed \d+ times: TypeError', seen.red['Callbacks'])
    kernel.run(TALKER)
    assert look(kernel).exit_code == 0


def test_node_whose_init_has_failed_is_half_made(kernel) -> None:
    kernel.run(SETUP)
    failed = kernel.run(TALKER.replace('self.create_timer', 'self.creat_timer'))
    assert failed.error.startswith('AttributeError')
    seen = look(kernel)
    assert set(seen.red) == {'Nodes'}
    assert '/talker is half made: an error has ended its __init__.' in seen.red['Nodes']
    assert 'nobody spins it' not in seen.text
    kernel.run(TALKER)
    assert look(kernel).exit_code == 0


def test_no_fault_hides_another_one_of_its_line(kernel) -> None:
    kernel.run(SETUP + TALKER.replace('self.count += 1', 'self.count += "one"'))
    kernel.run(
        'from rclpy.parameter import Parameter\n'
        'def late(name):\n'
        '    given = [Parameter("use_sim_time", value=True), Parameter("sped", value=1)]\n'
        '    return Node(name, parameter_overrides=given)\n'
        'waiting = lab.spin(late("waiting"))\nidle = late("idle")\nidle.create_timer(1.0, print)\n'
        'lab.wait_until(lambda: runtime.console.errors)'
    )
    seen = look(kernel)
    assert 'on_timer of /talker failed' in seen.red['Callbacks']
    assert '/waiting uses simulated time' in seen.red['Callbacks']
    assert '/idle was made, but nobody spins it' in seen.red['Nodes']
    assert "is given the parameter 'sped', which it never" in seen.red['Nodes']


@pytest.mark.slow('waits for what hangs')
def test_callback_that_does_not_return(kernel) -> None:
    kernel.run(SETUP + 'import threading\ngate = threading.Event()\nreached = threading.Event()')
    stuck = TALKER.replace('self.count += 1', 'reached.set(); gate.wait()')
    kernel.run(stuck + 'assert reached.wait(60)')
    seen = look(kernel)
    assert seen.exit_code == 1
    assert set(seen.red) == {'Middleware'}
    assert 'the callback on_timer of /talker has been running' in seen.red['Middleware']
    kernel.run('gate.set()')
    assert look(kernel).exit_code == 0
