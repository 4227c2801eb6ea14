"""ROS 2 in a notebook, pleasant and safe: `import labkit as lab`.

Importing this package is light. It sets the environment that ROS reads when it is loaded, and
loads the rest when a name is first used, so that it works in a bare Python too: that is how
`python3 -m labkit` sets up a fresh machine.
"""

from __future__ import annotations

import importlib
import sys
from typing import TYPE_CHECKING

from labkit.errors import LabError, LabTimeout, SetupError
from labkit.settings import prepare_environment

if TYPE_CHECKING:
    # For editors and type checkers, which can't follow `__getattr__`.
    from labkit.background.child_processes import processes
    from labkit.background.joining import join
    from labkit.background.spinning import remove, spin, start, stop
    from labkit.background.waiting import (
        listen,
        wait_for_message,
        wait_for_subscribers,
        wait_until,
    )
    from labkit.background.workspace import build, source
    from labkit.bags.player import play
    from labkit.bags.recorder import record
    from labkit.checkup.report import doctor
    from labkit.exercises.lesson import lesson
    from labkit.exercises.membership import join_class, leave_class
    from labkit.exercises.progress import progress
    from labkit.packages.export import export
    from labkit.sim.turtlebot import Turtlebot
    from labkit.teaching.classroom import classroom
    from labkit.views.arena import arena
    from labkit.views.bag import bag
    from labkit.views.graph import graph
    from labkit.views.image import image
    from labkit.views.monitor import monitor
    from labkit.views.plot import plot
    from labkit.views.projector import projector
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
    'doctor',
    'export',
    'graph',
    'image',
    'join',
    'join_class',
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
    'source',
    'spin',
    'start',
    'stop',
    'teleop',
    'wait_for_message',
    'wait_for_subscribers',
    'wait_until',
]

# Public name -> the module that defines it.
_HOMES = {
    'Turtlebot': 'labkit.sim.turtlebot',
    'arena': 'labkit.views.arena',
    'bag': 'labkit.views.bag',
    'build': 'labkit.background.workspace',
    'classroom': 'labkit.teaching.classroom',
    'doctor': 'labkit.checkup.report',
    'export': 'labkit.packages.export',
    'graph': 'labkit.views.graph',
    'image': 'labkit.views.image',
    'join': 'labkit.background.joining',
    'join_class': 'labkit.exercises.membership',
    'leave_class': 'labkit.exercises.membership',
    'lesson': 'labkit.exercises.lesson',
    'listen': 'labkit.background.waiting',
    'monitor': 'labkit.views.monitor',
    'play': 'labkit.bags.player',
    'plot': 'labkit.views.plot',
    'processes': 'labkit.background.child_processes',
    'progress': 'labkit.exercises.progress',
    'projector': 'labkit.views.projector',
    'record': 'labkit.bags.recorder',
    'remove': 'labkit.background.spinning',
    'source': 'labkit.background.workspace',
    'spin': 'labkit.background.spinning',
    'start': 'labkit.background.spinning',
    'stop': 'labkit.background.spinning',
    'teleop': 'labkit.views.teleop',
    'wait_for_message': 'labkit.background.waiting',
    'wait_for_subscribers': 'labkit.background.waiting',
    'wait_until': 'labkit.background.waiting',
}

# Reading one of these names starts ROS. In `lab.spin(Talker())` Python reads `lab.spin`, then
# builds the talker, which needs ROS, then calls; and after `lab.lesson(...)` a lesson makes nodes.
_START_ROS = ('lesson', 'spin')


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    try:
        function = getattr(importlib.import_module(_HOMES[name]), name)
        if name in _START_ROS:
            importlib.import_module('labkit.background.spinning').start()
    except ModuleNotFoundError as error:
        raise SetupError(
            f'{error.name!r} is missing in this Python, {sys.executable}.',
            todo='Start the course with: python3 -m labkit lab (in another editor: choose the '
            'Python of the folder .venv as the kernel).',
        ) from error
    return function


def __dir__() -> list[str]:
    return sorted(__all__)


prepare_environment()
if 'IPython' in sys.modules:
    for _home in ('labkit.ros2.magic', 'labkit.views.node_card', 'labkit.views.figure'):
        importlib.import_module(_home).register()
