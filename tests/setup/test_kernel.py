"""The course in a kernel of somebody else's, with the packages that Google Colab has."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from courses import ROOT, base_python
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import KernelManager

from labkit.setup.installer import Progress, install
from labkit.setup.machine import clean_environment

PINS = Path(__file__).with_name('colab.txt')
TIMEOUT_SEC = 120
ENTER = f'%run {ROOT}/labkit/setup/kernel.py'
TALKER = """
import labkit as lab
lab.start()
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.05, self.say)
        self.count = 0

    def say(self):
        self.count += 1
        self.get_logger().info(f'word {self.count}')
        self.publisher.publish(String(data='Hello'))

talker = lab.spin(Talker())
"""


class Kernel:
    """A kernel of another environment than the course's."""

    def __init__(self, python: Path, folder: Path) -> None:
        self.python = python
        # Sockets of its own instead of ports, which others may take before the kernel has them.
        # Their names must be short.
        self._sockets = tempfile.TemporaryDirectory(prefix='labkit-')
        self._manager = KernelManager(
            kernel_name='colab',
            transport='ipc',
            ip=str(Path(self._sockets.name) / 'socket'),
        )
        self._manager._kernel_spec = KernelSpec(  # there is no folder of kernels to find it in
            argv=[str(python), '-m', 'ipykernel_launcher', '-f', '{connection_file}']
        )
        left_out = ('COVERAGE', 'JPY_', 'LABKIT_', 'PYTEST_', 'PYTHONPATH', 'ROS_', 'VIRTUAL_ENV')
        variables = {
            name: value
            for name, value in clean_environment().items()
            if not name.startswith(left_out)
        }
        own = {name: str(folder) for name in ('HOME', 'IPYTHONDIR', 'LABKIT_HOME')}
        self._manager.start_kernel(
            cwd=str(folder), env={**variables, **own}, stderr=subprocess.DEVNULL
        )
        self._client = self._manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=TIMEOUT_SEC)

    def run(self, code: str) -> tuple[str, str, list[str]]:
        """Run a cell; return its request, what it prints or raises, and what else it sends."""
        text, kinds = '', []

        def collect(message: dict) -> None:
            nonlocal text
            content = message['content']
            if message['msg_type'] == 'stream':
                text += content['text']
            elif message['msg_type'] == 'error':
                text += f'{content["ename"]}: {content["evalue"]}'
            else:
                text += content.get('data', {}).get('text/plain', '')
            kinds.append(message['msg_type'])

        # A kernel that stops on errors drops what is asked in the moment after one.
        reply = self._client.execute_interactive(
            code,
            output_hook=collect,
            timeout=TIMEOUT_SEC,
            allow_stdin=False,
            stop_on_error=False,
        )
        return reply['parent_header']['msg_id'], text, kinds

    def next_text(self, of: str) -> str:
        """Wait for what is printed next on behalf of a cell that has ended."""
        while True:
            message = self._client.get_iopub_msg(timeout=TIMEOUT_SEC)
            if message['msg_type'] == 'stream' and message['parent_header']['msg_id'] == of:
                return str(message['content']['text'])

    def completions(self, code: str) -> tuple[str, list[str]]:
        """Return what Tab replaces, and by what."""
        answer = self._client.complete(code, reply=True, timeout=TIMEOUT_SEC)['content']
        return code[answer['cursor_start'] : answer['cursor_end']], answer['matches']

    def close(self) -> None:
        self._client.stop_channels()
        self._manager.shutdown_kernel(now=True)
        self._sockets.cleanup()


@pytest.fixture(scope='module')
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    folder = tmp_path_factory.mktemp('colab')
    python = folder / 'python' / 'bin' / 'python'
    make = [base_python(), '-I', '-m', 'venv', '--without-pip', str(folder / 'python')]
    subprocess.run(make, check=True, env=clean_environment())
    install(python, folder, [str(PINS)], Progress(0), lambda: 0, ['--no-deps'])
    kernel = Kernel(python, folder)
    assert kernel.run(ENTER)[1] == ''
    yield kernel
    kernel.close()


@pytest.mark.slow('installs packages')
def test_its_packages_stay_its_own(kernel: Kernel) -> None:
    _, text, _ = kernel.run(
        'import IPython, ipykernel, ipywidgets, numpy, tornado, rclpy\n'
        'print(IPython.__version__, ipykernel.__version__, ipywidgets.__version__)\n'
        'print(numpy.__file__)\nprint(tornado.__file__)\nprint(rclpy.__file__)'
    )
    versions, numpy, tornado, rclpy = text.splitlines()
    assert versions == '7.34.0 6.17.1 7.7.1'
    own = str(kernel.python.parents[1])
    assert numpy.startswith(own) and tornado.startswith(own)
    assert rclpy.startswith(str(ROOT / '.venv'))
    # Nothing was installed there.
    assert not list(Path(own).glob('lib/python*/site-packages/*ros*'))
    # To enter again is no harm.
    assert kernel.run(f'{ENTER}\nimport sys\nprint(sys.path.count({str(ROOT)!r}))')[1] == '1\n'


@pytest.mark.slow('a kernel of another environment')
def test_what_a_node_says_belongs_to_its_cell(kernel: Kernel) -> None:
    cell, _, kinds = kernel.run(TALKER)
    assert 'error' not in kinds
    kernel.run('1 + 1')
    assert 'word ' in kernel.next_text(cell)
    _, listed, _ = kernel.run('%ros2 topic list')
    assert '/chatter' in listed
    # Its processes are in the environment.
    assert '/chatter' in kernel.run('!ros2 topic list')[1]
    kernel.run('lab.stop()')


def test_errors_are_told_in_a_sentence(kernel: Kernel) -> None:
    _, text, _ = kernel.run("import labkit as lab\nlab.start()\nlab.remove('talkr')")
    assert text.startswith("LabError: No node called 'talkr' runs in this notebook.")
    assert kernel.run('1/0')[1] == 'ZeroDivisionError: division by zero'
    report = ' '.join(kernel.run('lab.doctor()')[1].split())
    assert 'JupyterLab not of this environment: ' in report and 'ipykernel 6.17.1' in report
    assert 'All is well.' in report


def test_tab_completes_words_of_ros2(kernel: Kernel) -> None:
    kernel.run('import labkit as lab\nlab.start()')
    # This IPython adds words of Python's.
    replaced, words = kernel.completions('%ros2 topic li')
    assert replaced == 'li' and 'list' in words
    kernel.run('lab.spin(lab.Turtlebot())')
    replaced, words = kernel.completions('%ros2 topic echo /cmd')
    assert '%ros2 topic echo /cmd'.removesuffix(replaced) + words[0] == (
        '%ros2 topic echo /cmd_vel'
    )


@pytest.mark.parametrize(
    'view',
    ['lab.graph()', 'lab.arena()', 'lab.teleop()', "lab.plot('/scan.ranges[0]')", 'quiz'],
)
def test_views_reach_the_page(kernel: Kernel, view: str) -> None:
    view = view.replace('quiz', "lab.lesson('odds').quiz()")
    _, text, kinds = kernel.run(f'import labkit as lab\nlab.start()\n{view}')
    assert 'comm_open' in kinds and 'error' not in kinds and text


def test_an_exercise_is_checked(kernel: Kernel) -> None:
    kernel.run('import labkit as lab\nlab.stop()\nlesson = lab.lesson("odds")')
    assert 'NOT ATTEMPTED' in kernel.run('lesson.count_up.check()')[1]
    kernel.run('exec(lesson.count_up.answer.code)')
    assert 'PASS' in kernel.run('lesson.count_up.check()')[1]


@pytest.mark.slow('installs packages')
def test_a_package_has_its_constants_first(kernel: Kernel) -> None:
    kernel.run('import labkit as lab\nlab.start()\nfrom rclpy.node import Node\nPERIOD = 0.5')
    kernel.run(
        'class Odds(Node):\n    def __init__(self):\n        super().__init__("odds")\n'
        '        self.create_timer(PERIOD, self.say)\n\n    def say(self):\n        pass'
    )
    _, text, _ = kernel.run(
        'lab.export(Odds, package="odds_lab")\n'
        'from pathlib import Path\nprint(next(Path.cwd().rglob("odds.py")).read_text())'
    )
    assert -1 < text.find('PERIOD = 0.5') < text.find('class Odds(Node)')
