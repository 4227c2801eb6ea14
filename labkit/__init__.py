"""ROS 2 in a notebook, pleasant and safe: `import labkit as lab`.

Importing this package is cheap. It sets the environment variables that ROS reads when it is
loaded, and imports modules when a name is first used, so that it works in a bare Python too: that
is how `python3 -m labkit` sets up a fresh machine.
"""

from __future__ import annotations

import importlib
import sys
from typing import TYPE_CHECKING

from labkit import stop_button
from labkit.errors import LabError, LabTimeout, SetupError
from labkit.settings import prepare_environment

if TYPE_CHECKING:
    # For editors and type checkers, which can't follow `__getattr__`.
    from labkit.asking.waiting import (
        listen,
        wait_for_message,
        wait_for_subscribers,
        wait_until,
    )
    from labkit.background.runtime import remove, spin, start, stop
    from labkit.bags.player import play
    from labkit.bags.recorder import record
    from labkit.checkup.report import doctor
    from labkit.exercises.record.membership import join_class, leave_class
    from labkit.exercises.record.progress import progress
    from labkit.exercises.setup_cell import lesson
    from labkit.launching.launched import launch
    from labkit.packages.export import export
    from labkit.packages.workspace import build, source
    from labkit.programs.child_processes import processes
    from labkit.sharing.domain import domain
    from labkit.sharing.joining import join
    from labkit.sim.turtlebot import Turtlebot
    from labkit.teaching.classroom import classroom
    from labkit.views.arena import arena
    from labkit.views.bag import bag
    from labkit.views.dock import dock
    from labkit.views.frames import frames
    from labkit.views.graph import graph
    from labkit.views.image import image
    from labkit.views.joint_state_publisher_gui import joint_state_publisher_gui
    from labkit.views.monitor import monitor
    from labkit.views.plot import plot
    from labkit.views.projector import projector
    from labkit.views.scene_view import scene
    from labkit.views.teleop import teleop

__version__ = '0.1.0'

__all__ = [
    'LabError',
    'LabTimeout',
    'Turtlebot',
    'arena',
    'bag',
    'build',
    'classroom',
    'dock',
    'doctor',
    'domain',
    'export',
    'frames',
    'graph',
    'image',
    'join',
    'join_class',
    'joint_state_publisher_gui',
    'launch',
    'leave_class',
    'lesson',
    'listen',
    'monitor',
    'play',
    'plot',
    'processes',
    'progress',
    'projector',
    'record',
    'remove',
    'scene',
    'source',
    'spin',
    'start',
    'stop',
    'teleop',
    'wait_for_message',
    'wait_for_subscribers',
    'wait_until',
]

# Public name -> its module.
_HOMES = {
    'Turtlebot': 'labkit.sim.turtlebot',
    'arena': 'labkit.views.arena',
    'bag': 'labkit.views.bag',
    'build': 'labkit.packages.workspace',
    'classroom': 'labkit.teaching.classroom',
    'dock': 'labkit.views.dock',
    'doctor': 'labkit.checkup.report',
    'domain': 'labkit.sharing.domain',
    'export': 'labkit.packages.export',
    'frames': 'labkit.views.frames',
    'graph': 'labkit.views.graph',
    'image': 'labkit.views.image',
    'join': 'labkit.sharing.joining',
    'join_class': 'labkit.exercises.record.membership',
    'joint_state_publisher_gui': 'labkit.views.joint_state_publisher_gui',
    'launch': 'labkit.launching.launched',
    'leave_class': 'labkit.exercises.record.membership',
    'lesson': 'labkit.exercises.setup_cell',
    'listen': 'labkit.asking.waiting',
    'monitor': 'labkit.views.monitor',
    'play': 'labkit.bags.player',
    'plot': 'labkit.views.plot',
    'processes': 'labkit.programs.child_processes',
    'progress': 'labkit.exercises.record.progress',
    'projector': 'labkit.views.projector',
    'record': 'labkit.bags.recorder',
    'remove': 'labkit.background.runtime',
    'scene': 'labkit.views.scene_view',
    'source': 'labkit.packages.workspace',
    'spin': 'labkit.background.runtime',
    'start': 'labkit.background.runtime',
    'stop': 'labkit.background.runtime',
    'teleop': 'labkit.views.teleop',
    'wait_for_message': 'labkit.asking.waiting',
    'wait_for_subscribers': 'labkit.asking.waiting',
    'wait_until': 'labkit.asking.waiting',
}

# Reading these names starts ROS. In `lab.spin(Talker())` Python reads `lab.spin`, then makes the
# talker, which needs ROS, then calls; and after `lab.lesson(...)` a lesson makes nodes.
_START_ROS = ('lesson', 'spin')


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    try:
        with stop_button.held():
            function = getattr(importlib.import_module(_HOMES[name]), name)
            if name in _START_ROS:
                importlib.import_module('labkit.background.runtime').start()
    except ModuleNotFoundError as error:
        raise SetupError(
            f'{error.name!r} is missing in this Python, {sys.executable}.',
            todo='Start the course with: python3 -m labkit lab (in another editor: choose the '
            'Python of the folder .venv as the kernel).',
        ) from error
    return function


def __dir__() -> list[str]:
    return sorted(__all__)


# pytest imports this for its plugin in each of its runs: labkit/course/pytest_plugin.py undoes it.
prepare_environment()
if 'IPython' in sys.modules:
    with stop_button.held():
        for _home in (
            'labkit.packages.imports',
            'labkit.programs.shell_cells',
            'labkit.ros2.magic',
            'labkit.views.launch_card',
            'labkit.views.node_card',
            'labkit.views.matplotlib_figures',
            'labkit.silent',
            'labkit.asking',
        ):
            importlib.import_module(_home).register()
