"""`lab.export`: what comes along into the package, and what is named because it can not."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from textwrap import dedent

import pytest

from labkit.background import domains

SETUP = 'import labkit as lab\n'
TALKER = """\
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.1, self.on_timer)
        self.count = 0

    def on_timer(self):
        self.publisher.publish(String(data=f'Hello World: {self.count}'))
        self.count += 1
"""
MODULE = '''\
"""The node Talker of the package talk."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.1, self.on_timer)
        self.count = 0

    def on_timer(self):
        self.publisher.publish(String(data=f'Hello World: {self.count}'))
        self.count += 1


def main(args=None):
    """Run the node until it is interrupted."""
    rclpy.init(args=args)
    node = Talker()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
'''
EXPORT = (
    "lab.export({}, package='talk', folder='src', maintainer_name='me', "
    "maintainer_email='me@example.org', overwrite=True)"
)


@pytest.fixture
def notebook(kernel):
    """Give a function that runs cells; it returns the result of the last one."""
    kernel.run(SETUP)

    def run(*cells: str):
        for cell in cells[:-1]:
            result = kernel.run(dedent(cell))
            assert not result.error, result.traceback
        return kernel.run(dedent(cells[-1]))

    return run


@pytest.fixture
def source(notebook, kernel) -> Callable[..., str]:
    """Give a function that runs cells, exports `Talker`, and returns its module."""

    def run(*cells: str) -> str:
        result = notebook(*cells, EXPORT.format('Talker'))
        assert not result.error, result.traceback
        text = (kernel.folder / 'src/talk/talk/talker.py').read_text()
        ast.parse(text)
        return text

    return run


def test_a_class_becomes_a_package(source, kernel):
    assert source(TALKER) == MODULE
    src = kernel.folder / 'src/talk'
    xml = (src / 'package.xml').read_text()
    assert (
        '  <depend>rclpy</depend>\n  <depend>std_msgs</depend>\n\n  <test_depend>python3-pyt'
        in xml
    )
    assert "'talker = talk.talker:main'" in (src / 'setup.py').read_text()
    assert "assert node.get_name() == 'talker'" in (src / 'test/test_talker.py').read_text()
    assert (src / 'LICENSE').is_file()


def test_what_it_shows(notebook):
    assert notebook(TALKER, EXPORT.format('Talker')).text == dedent("""\
        Package talk in src/talk
          LICENSE
          package.xml
          resource/talk
          setup.cfg
          setup.py
          talk/__init__.py
          talk/talker.py
          test/test_talker.py
        It depends on: rclpy, std_msgs
        When it is built and sourced:
          ros2 run talk talker
        """)


def test_what_other_cells_have_made_comes_along(source):
    """The cells are those of the kernel: the latest ones, a magic at the top of one included."""
    text = source(
        TALKER.replace('Hello', 'Old'),
        'WORD = "old"',
        '%%capture\ndef word():\n    return WORD',
        'WORD = "new"',
        TALKER.replace("f'Hello", "word() + f'"),
        'WORD',
    )
    assert 'Old' not in text, text
    assert 'WORD = "new"\n' in text and 'def word():' in text


def test_what_can_not_come_along_is_named(notebook, kernel):
    speed = 'speed = 3\n\n' + TALKER.replace('self.count += 1', 'self.count += sped')
    said = notebook(speed, EXPORT.format('Talker')).error
    assert said.startswith(
        "LabError: Talker can not become a package: it uses 'sped'.\nCell In[2], line 16: "
        'self.count += sped\nNo cell of this notebook has made it.\n'
    )
    shell = TALKER.replace('self.count += 1', '%ros2 node list')
    said = notebook(shell, EXPORT.format('Talker')).error
    assert "uses 'get_ipython'.\nCell In[4], line 14: get_ipython().run_line_magic" in said
    said = notebook(TALKER, 'Talker = lab.spin(Talker())', EXPORT.format('Talker')).error
    assert 'lab.export takes the class, and Talker() is one of its nodes.' in said
    assert not (kernel.folder / 'src').exists()


def test_what_only_happens_to_be_loaded_is_imported(source):
    """Here, `import rclpy` is enough: something else in the kernel has loaded `rclpy.node`."""
    text = source(
        """\
        import importlib

        import numpy as np
        import rclpy, geometry_msgs, example_interfaces
        import rclpy.node
        from geometry_msgs.msg import Point
        """,
        """\
        class Talker(rclpy.node.Node):
            def __init__(self):
                super().__init__('talker')
                self.place = geometry_msgs.msg.Point(x=np.linalg.norm([3.0, 4.0]))
                self.types = example_interfaces.msg
                self.found = importlib.util.find_spec('talk')
        """,
    )
    assert text.partition('\n\nclass')[0] == dedent("""\
        \"""The node Talker of the package talk.\"""

        import importlib
        import importlib.util

        import example_interfaces
        import example_interfaces.msg
        import geometry_msgs
        import geometry_msgs.msg
        import numpy as np
        import rclpy
        from rclpy.executors import ExternalShutdownException
        import rclpy.node
        """)


def test_what_does_not_load_without_the_notebook_is_named(notebook, kernel):
    """Nothing is written, nothing started, and nothing that is printed is shown."""
    (kernel.folder / 'helpers.py').write_text('WORD = "hello"\n')
    (kernel.folder / 'word.txt').write_text('hello')
    helped = 'from helpers import WORD\n' + TALKER.replace("'chatter'", 'WORD')
    said = notebook(helped, EXPORT.format('Talker')).error
    assert said.startswith(
        'LabError: Talker can not become a package: its module does not load in a fresh Python.\n'
        'Cell In[2], line 1: from helpers import WORD\n'
        "ModuleNotFoundError: No module named 'helpers'\n"
        'Here, it is loaded from '
    )
    assert f'{kernel.folder.name}/helpers.py, where no program looks.' in said
    kept = "# What it says.\nWORD = [\n    print('hi'),\n    open('word.txt').read(),\n][1]\n"
    result = notebook(kept + TALKER.replace("'chatter'", 'WORD'), EXPORT.format('Talker'))
    assert "\nCell In[4], line 4: open('word.txt').read(),\nFileNotFoundError: " in result.error
    assert 'neither the other cells nor the folder of this notebook' in result.error
    assert 'hi' not in result.text
    assert not (kernel.folder / 'src').exists()


def test_variables_that_a_cell_has_set_are_not_there(notebook, source):
    notebook('import os', "os.environ['ROBOT'] = 'r2'", 'ROBOT = os.environ["ROBOT"]')
    talker = TALKER.replace("'chatter'", 'ROBOT')
    result = notebook(talker, EXPORT.format('Talker'))
    assert 'Cell In[4], line 1: ROBOT = os.environ["ROBOT"]\nKeyError: ' in result.error
    assert 'nor variables that a cell has set' in ' '.join(result.error.split())
    # Those from before are.
    assert 'HOME' in source('ROBOT = os.environ["HOME"]', talker)


def test_a_folder_that_is_there(notebook, kernel):
    plain = EXPORT.replace(', overwrite=True', '').format('Talker')
    notebook(TALKER, plain)
    assert 'src/talk is there already.' in notebook(plain).error
    own = kernel.folder / 'src/talk'
    (own / 'talk/old.py').write_text('')
    assert not notebook(EXPORT.format('Talker')).error
    assert not (own / 'talk/old.py').exists()
    (own / 'package.xml').unlink()
    said = notebook(EXPORT.format('Talker')).error
    assert 'is no package of that name: it is not overwritten' in said
    assert (own / 'setup.py').exists()


def test_a_package_that_can_not_be_written_costs_nothing(notebook, kernel):
    notebook(TALKER, EXPORT.format('Talker'))
    own = kernel.folder / 'src/talk'
    (own / 'notes.txt').write_text('mine')
    full = """
        from labkit.packages.skeleton import Part

        def refuse(part, folder):
            raise OSError(28, 'No space left on device', part.path)

        Part.write, write = refuse, Part.write
    """
    assert 'can not be made: No space left' in notebook(full, EXPORT.format('Talker')).error
    assert (own / 'notes.txt').read_text() == 'mine'
    assert [path.name for path in own.parent.iterdir()] == ['talk']


@pytest.mark.slow('exports several packages')
def test_a_folder_of_another_name_that_has_the_package(notebook, kernel):
    notebook(TALKER, EXPORT.format('Talker'))
    src = kernel.folder / 'src'
    (src / 'talk').rename(src / 'my_talk')
    said = ' '.join(notebook(EXPORT.format('Talker')).error.split())
    assert 'src/my_talk is a package with the name talk, too, and colcon builds each name' in said
    assert not (src / 'talk').exists()
    (src / 'my_talk').rename(src / 'talk')
    assert not notebook(EXPORT.format('Talker')).error


def test_several_classes_and_other_packages(notebook, kernel):
    listener = TALKER.replace('Talker', 'ListenerABTest').replace("'talker'", "'ear'")
    result = notebook(TALKER, f'import yaml, rosbags\n{listener}', 'pass')
    used = listener.replace('self.count += 1', 'yaml, rosbags')
    result = notebook(used, EXPORT.format('Talker, ListenerABTest'))
    assert '  talk/listener_ab_test.py\n' in result.text and '  talk/talker.py\n' in result.text
    assert 'It depends on: rclpy, std_msgs, python3-yaml\n' in result.text
    assert 'Add to package.xml what brings: rosbags\n' in result.text
    setup = (kernel.folder / 'src/talk/setup.py').read_text()
    assert (
        "            'talker = talk.talker:main',\n"
        "            'listener_ab_test = talk.listener_ab_test:main'\n"
    ) in setup


def test_bad_names_of_a_package(notebook):
    assert 'Which class?' in notebook("lab.export(package='x')").error
    assert 'robot_lab' in notebook("lab.export(package='robot-lab')").error


def test_a_class_of_a_script_can_be_exported(script, tmp_path):
    code = f"{SETUP}{TALKER}\n\nprint(lab.export(Talker, package='talk'))\n"
    assert 'ros2 run talk talker' in script(code).stdout
    assert (tmp_path / 'talk/talk/talker.py').read_text() == MODULE


@pytest.fixture
def domain() -> Iterator[str]:
    """Give the number of a domain in which no other test is."""
    claim = domains.claim_domain()
    yield str(claim.domain_id)
    claim.close()


@pytest.mark.timeout(300)
def test_it_is_built_tested_and_run_without_labkit(source, kernel, lab_env, domain):
    """The real colcon, in a workspace, as a learner does it; the talker is heard from outside."""
    source(TALKER)
    env = {**lab_env, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': domain}
    env['PATH'] = os.pathsep.join([str(Path(sys.prefix, 'bin')), env['PATH']])
    del env['PYTHONPATH']

    def bash(words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ['bash', '-c', words],
            cwd=kernel.folder,
            env=env,
            capture_output=True,
            text=True,
            timeout=200,
        )

    built = bash('colcon build')
    assert built.returncode == 0 and '1 package finished' in built.stdout, built
    tested = bash('colcon test --event-handlers console_direct+ && colcon test-result')
    assert 'Summary: 1 test, 0 errors, 0 failures, 0 skipped' in tested.stdout, tested
    unsourced = bash('ros2 run talk talker')
    assert unsourced.stderr == (
        "Package 'talk' not found\nIt is built in this folder, but this terminal does not know it "
        'yet: source install/setup.bash\n'
    )
    heard = bash(
        'source install/setup.bash; ros2 run talk talker & '
        'ros2 topic echo --once --timeout 60 /chatter std_msgs/msg/String; kill -INT $!; wait $!'
    )
    # Where the talker is the slower one to start, a line before says that nobody publishes yet.
    assert "data: 'Hello World: " in heard.stdout, heard
    # The signal may come when rclpy is about to wait, or while the timer publishes: then an error
    # of a private type says that ROS is shut down. Nothing else may be said.
    shut_down = ('the given context is not valid', "publisher's context is invalid")
    if not any(words in heard.stderr for words in shut_down):
        assert (heard.returncode, 'Traceback' in heard.stderr) == (0, False), heard
    assert bash('source install/setup.bash; ros2 pkg executables talk').stdout == 'talk talker\n'
    assert 'install/talk\n' in bash('source install/setup.bash; ros2 pkg prefix talk').stdout


def test_launch_files_come_along_and_are_installed(kernel):
    kernel.run(SETUP)
    (kernel.folder / 'a.launch.xml').write_text('<launch/>')
    kernel.run(TALKER)
    files = ", launch_files=['a.launch.xml'], overwrite=True"
    result = kernel.run(EXPORT.replace(', overwrite=True', files).format('Talker'))
    assert not result.error, result
    package = kernel.folder / 'src' / 'talk'
    assert (package / 'launch' / 'a.launch.xml').read_text() == '<launch/>'
    line = "        ('share/' + package_name + '/launch', ['launch/a.launch.xml']),\n"
    assert line in (package / 'setup.py').read_text()
    ast.parse((package / 'setup.py').read_text())
    missing = EXPORT.replace(', overwrite=True', files.replace('a.', 'b.')).format('Talker')
    assert 'The launch file b.launch.xml can not be read' in kernel.run(missing).error
