"""What `import` does in a notebook, beyond finding what is installed.

`import rclpy` puts the stand-ins for its functions in place at once, so that a program that is
pasted before labkit has started ROS runs as one that is pasted afterwards. A package of ROS that
no wheel has is named: what it is, and what to use here.

What is installed is loaded as a whole. Python takes a module away whose load the stop button has
ended, but not the parts that were loaded by then; the next import finds those, and does not make
them attributes of the new module ("module 'rclpy' has no attribute 'client'"), and a library in C
may be loaded only once. So the button waits until the load has ended. The learner's own modules
are interrupted at once, and what is imported before labkit is Python's own business.
"""

from __future__ import annotations

import importlib
import os
import re
import shutil
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib.machinery import ModuleSpec, SourceFileLoader
from types import ModuleType

from labkit import settings, stop_button
from labkit.errors import LabError

__all__ = ['register', 'why_not_installed']

_REAL = 'It comes with an installed ROS 2 (apt install ros-jazzy-{}), not with wheels.'
# Package -> what it is and what to use here, where to find it.
_UNAVAILABLE = {
    'tf_transformations': (
        'quaternions and matrices. Here, `pip install transforms3d` has the same functions',
        _REAL.format('tf-transformations'),
    ),
    'cv_bridge': (
        'a converter of images for OpenCV. Here, numpy does it: np.frombuffer(msg.data, '
        'np.uint8).reshape(msg.height, msg.width, -1)',
        _REAL.format('cv-bridge'),
    ),
    **dict.fromkeys(
        ('launch', 'launch_ros', 'launch_xml', 'launch_yaml'),
        ('what launch files are written with. Here, lab.launch starts such a file', ''),
    ),
    **{
        name: ('what launch files are tested with', _REAL.format(name.replace('_', '-')))
        for name in ('launch_pytest', 'launch_testing', 'launch_testing_ros')
    },
    'rospy': (
        'ROS 1, which has another interface. Lesson 01 has a table of what is what in rclpy',
        'ROS 1 is not supported any more.',
    ),
    'roslib': ('ROS 1. Nothing takes its place: rclpy needs no manifest', ''),
    'rosbag': ('the bags of ROS 1. Here, lab.record, lab.play and lab.bag', ''),
    'rosbag2_py': (
        'the reader and writer of bags. Here, lab.record, lab.play and lab.bag',
        _REAL.format('rosbag2-py'),
    ),
    'tf': ('the frames of ROS 1; in ROS 2 they are in tf2_ros', ''),
    'nav2_simple_commander': (
        'the navigation of Nav2',
        _REAL.format('nav2-simple-commander'),
    ),
    'nav2_msgs': ('the types of Nav2', _REAL.format('nav2-msgs')),
    'control_msgs': ('types of ros2_control', _REAL.format('control-msgs')),
    'message_filters': (
        'a filter that pairs messages of several topics by their stamps',
        _REAL.format('message-filters'),
    ),
    'moveit_configs_utils': (
        'what launch files of MoveIt are written with',
        _REAL.format('moveit-configs-utils'),
    ),
    **dict.fromkeys(
        ('ros2cli', 'ros2run', 'ros2launch', 'ros2topic', 'ros2node', 'ros2param', 'ros2bag'),
        ('the program ros2. Here, %ros2 has its words', ''),
    ),
    **{
        name: ('a part of tf2, the frames', _REAL.format(name.replace('_', '-')))
        for name in ('tf2_kdl', 'tf2_tools')
    },
    **{
        name: ('MoveIt, which plans how an arm moves', _REAL.format('moveit-py'))
        for name in ('moveit', 'moveit_py')
    },
    'rosidl_runtime_py': (
        'what finds a class by its name, and turns messages into text. Here, import the class '
        'itself, and print the message',
        _REAL.format('rosidl-runtime-py'),
    ),
    **{
        name: (what, _REAL.format(name.replace('_', '-')))
        for name, what in (
            ('controller_manager', 'a part of ros2_control'),
            ('diagnostic_updater', 'what tells the state of a device'),
            ('image_geometry', 'the geometry of a camera'),
            ('image_transport_py', 'what sends images in compressed form'),
        )
    },
    'nav2_common': ('what launch files of Nav2 are written with', _REAL.format('nav2-common')),
    'urdf_parser_py': ('a reader of descriptions of robots', _REAL.format('urdfdom-py')),
    **dict.fromkeys(
        ('rqt_gui', 'rqt_gui_py', 'rqt_py_common', 'python_qt_binding'),
        ('the windows of rqt. Here, lab.graph, lab.monitor and lab.plot', ''),
    ),
    'actionlib': ('the actions of ROS 1; in ROS 2 they are in rclpy.action', ''),
    'dynamic_reconfigure': ('a part of ROS 1; in ROS 2, a node has parameters', ''),
    'moveit_commander': ('the MoveIt of ROS 1', ''),
    **dict.fromkeys(
        ('rosnode', 'rosparam', 'rosservice', 'rostopic', 'rosgraph', 'roslaunch', 'ros_numpy'),
        ('a part of ROS 1, which has another interface', ''),
    ),
}
# By their names, packages of types.
_OF_TYPES = re.compile(r'\w+_(msgs|interfaces|srvs|actions)')

# Fast DDS writes that much to shared memory while it is loaded. Where it does not fit, the system
# ends the process with a bus error.
_LOADING_BYTES = 8192
_STAND_INS = 'labkit.background.runtime'  # it installs them when it is loaded
# Where there is nothing of the learner's.
_INSTALLED = tuple(
    os.path.join(folder, '')
    for folder in (sys.prefix, sys.base_prefix, os.path.dirname(os.path.dirname(__file__)))
)


def register() -> None:
    """Follow the imports of a kernel. Without effect elsewhere."""
    if not settings.in_kernel():
        return
    if 'rclpy' in sys.modules:
        importlib.import_module(_STAND_INS)
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())


class _Finder:
    """Asks all other finders, and lets what is installed be loaded as a whole."""

    def __init__(self) -> None:
        # Modules that were loaded when the stop button ended their import.
        self._loaded: dict[str, ModuleType] = {}

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        for finder in sys.meta_path:
            find = getattr(finder, 'find_spec', None)
            if finder is self or find is None:
                continue
            spec: ModuleSpec | None = find(name, path, target)
            if spec is not None:
                loader = spec.loader
                if isinstance(loader, SourceFileLoader) and loader.path.startswith(_INSTALLED):
                    self._follow(loader)
                return spec
        if path is None and not _is_only_asked():
            error = why_not_installed(name)
            if error is not None:
                error.name = name
                raise error
        return None

    def _follow(self, loader: SourceFileLoader) -> None:
        load = loader.exec_module

        def create_module(spec: ModuleSpec) -> ModuleType | None:
            return self._loaded.get(spec.name)

        def exec_module(module: ModuleType) -> None:
            name = module.__name__
            if self._loaded.pop(name, None) is module:
                return
            with stop_button.held():
                if name == 'rclpy':
                    _look_at_shared_memory()
                try:
                    load(module)
                except ImportError as error:
                    # numpy, and it says no more than that.
                    if '.' in name or 'cannot load module more than once' not in str(error):
                        raise
                    raise _HalfLoaded(
                        f'{name} was loaded in part before, and a process can load it only once.',
                        todo='Restart the kernel (menu Kernel), and run the cells from the top.',
                    ) from error
                if name == 'rclpy':
                    importlib.import_module(_STAND_INS)
                self._loaded[name] = sys.modules[name]
            del self._loaded[name]

        loader.create_module = create_module  # type: ignore[method-assign]
        loader.exec_module = exec_module  # type: ignore[method-assign]


def why_not_installed(name: str) -> _NotInWheels | None:
    """Return what to say of a package that is not there; None for what is no part of ROS."""
    if name in _UNAVAILABLE:
        what, where = _UNAVAILABLE[name]
        return _NotInWheels(f'{name} is not installed here. It is {what}.', todo=where)
    if _OF_TYPES.fullmatch(name):
        from labkit.rosgraph.workspaces import why_missing

        return _NotInWheels(
            f'{name} is not installed here. By its name, it is a package of types.',
            todo=why_missing(name)
            or 'If it is your own, build its workspace with lab.build(), as in lesson 12. Those '
            'of others come with an installed ROS 2, not with wheels: '
            f'apt install ros-jazzy-{name.replace("_", "-")}',
        )
    return None


def _look_at_shared_memory() -> None:
    free = _LOADING_BYTES
    with suppress(OSError):
        free = shutil.disk_usage('/dev/shm').free
    if free < _LOADING_BYTES:
        raise LabError(
            '/dev/shm is full, and loading ROS would end this process.',
            todo='Delete what fills it (ls -lS /dev/shm shows it), or restart the machine.',
        )


class _NotInWheels(LabError, ModuleNotFoundError):
    """A package of ROS that no wheel has. `except ImportError` catches it."""


class _HalfLoaded(LabError, ImportError):
    """A package that can't be loaded again in this process."""


def _is_only_asked() -> bool:
    """Return whether `importlib.util.find_spec` asks, which imports nothing."""
    frame = sys._getframe(2)
    while frame.f_globals.get('__name__') in ('importlib._bootstrap', '_frozen_importlib'):
        assert frame.f_back is not None
        frame = frame.f_back
    return frame.f_globals.get('__name__') == 'importlib.util'
