"""What `import` does in a notebook: packages that no wheel has, and the stop button meanwhile."""

from __future__ import annotations

import pytest

from labkit.packages.imports import _UNAVAILABLE


def test_what_tutorials_import_has_a_sentence():
    parts = 'tf2_kdl launch_xml launch_testing moveit moveit_commander'
    others = 'rosidl_runtime_py ros2run rqt_gui actionlib diagnostic_updater'
    assert {*parts.split(), *others.split()} <= _UNAVAILABLE.keys()


@pytest.mark.parametrize('command', ['import {}', 'from {} import Something', 'import {}.part'])
def test_a_package_that_no_wheel_has_is_named(kernel, command):
    kernel.run('import labkit as lab')
    for name, (what, where) in _UNAVAILABLE.items():
        result = kernel.run(command.format(name))
        assert f'{name} is not installed here. It is {what}.' in result.error
        assert where in result.error
        assert f'line 1: {command.format(name)}' in result.traceback


def test_a_package_of_types_is_told_by_its_name(kernel):
    kernel.run('import labkit as lab')
    result = kernel.run('from my_interfaces.msg import Num')
    assert 'my_interfaces is not installed here. By its name, it is a package of' in result.error
    assert 'lab.build()' in result.error and 'ros-jazzy-my-interfaces' in result.error
    (kernel.folder / 'ws/build/my_interfaces').mkdir(parents=True)
    (kernel.folder / 'ws/build/.built_by').write_text('colcon\n')
    (kernel.folder / 'ws/build/my_interfaces/colcon_build.rc').write_text('1\n')
    result = kernel.run('from my_interfaces.msg import Num')
    assert "my_interfaces has failed. Build it again, and read what it says: lab.build('ws')" in (
        result.error.replace('\n', ' ')
    )
    inside = kernel.run('import std_msgs.my_msgs')
    assert inside.error == "ModuleNotFoundError: No module named 'std_msgs.my_msgs'"


def test_code_that_does_without_such_a_package_goes_on(kernel):
    result = kernel.run(
        'import labkit as lab\n'
        'try:\n    import cv_bridge\nexcept ImportError as error:\n    print(error.name)'
    )
    assert (result.error, result.text) == ('', 'cv_bridge\n')
    asked = kernel.run('import importlib.util\nprint(importlib.util.find_spec("launch_ros"))')
    assert (asked.error, asked.text) == ('', 'None\n')
    other = kernel.run('import no_such_package')
    assert other.error == "ModuleNotFoundError: No module named 'no_such_package'"


def test_a_package_that_is_there_is_imported(kernel):
    kernel.run('from pathlib import Path\nPath("turtlesim.py").write_text("x = 1")')
    result = kernel.run('import labkit as lab\nimport turtlesim\nprint(turtlesim.x)')
    assert (result.error, result.text) == ('', '1\n')


# All that is loaded for the first node.
FIRST = """
import labkit as lab
from rclpy.node import Node
from sensor_msgs.msg import Image
node = lab.spin(Node('seer'))
heard = []
node.create_subscription(Image, 'seen', heard.append, 10)
node.create_publisher(Image, 'seen', 10).publish(Image())
"""
# Runs that cell in processes of their own, pressing the stop button at another step in each; then
# once more, in peace. A step is what Python tells auditors: an import, a file, a socket.
PRESS = f"""
import os, signal, sys
from ipykernel.inprocess.ipkernel import InProcessKernel

def run(press_at):
    shell, steps = InProcessKernel().shell, 0
    def step(event, args):
        nonlocal steps
        steps += 1
        if steps == press_at:
            signal.raise_signal(signal.SIGINT)
    shell.user_ns['audit'] = lambda: sys.addaudithook(step)
    first = shell.run_cell('audit()' + {FIRST!r})
    in_all, interrupted = steps, isinstance(first.error_in_exec, KeyboardInterrupt)
    again = shell.run_cell({FIRST!r} + 'lab.wait_until(lambda: heard, timeout_sec=60)')
    return in_all, interrupted, repr(again.error_before_exec or again.error_in_exec)

def forked(press_at):
    read, write = os.pipe()
    child = os.fork()
    if not child:
        os.dup2(2, 1)
        os.write(write, repr(run(press_at)).encode())
        os._exit(0)
    os.close(write)
    with open(read) as pipe:
        told = eval(pipe.read() or '0, False, "it died"')
    os.waitpid(child, 0)
    return told

steps = forked(0)[0]
for part in range(1, 7):
    print(*forked(steps * part // 7)[1:])
"""


@pytest.mark.slow('many kernels')
def test_the_stop_button_while_the_first_node_is_made_breaks_nothing(script):
    result = script(PRESS)
    assert result.stdout.splitlines() == ['True None'] * 6, result.stderr


def test_a_module_of_the_learner_is_interrupted_at_once(kernel):
    code = 'import threading\nprint("begun", flush=True)\nthreading.Event().wait()'
    kernel.run(f'import labkit as lab\nopen("endless.py", "w").write({code!r})')
    request = kernel.start('import endless')
    kernel.wait_for_output(request, 'begun')
    kernel.interrupt()
    assert kernel.finish(request).error.startswith('KeyboardInterrupt')


# Presses the stop button where numpy's library, which can be loaded only once, is half loaded.
PRESS_IN_NUMPY = """
import signal, sys
class Press:
    def find_spec(self, name, path=None, target=None):
        if name == 'numpy.exceptions' and 'numpy._core' in sys.modules:
            sys.meta_path.remove(self)
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Press())
import numpy
"""


def test_numpy_that_was_half_loaded_before_labkit_says_so(kernel):
    assert kernel.run(PRESS_IN_NUMPY).error.startswith('KeyboardInterrupt')
    for cell in ('import numpy', 'import numpy as np', 'from sensor_msgs.msg import LaserScan'):
        error = kernel.run(f'import labkit as lab\n{cell}').error
        assert 'numpy was loaded in part before, and a process can load it only once' in error
        assert 'Restart the kernel' in error
