"""ROS 2 in a notebook, pleasant and safe: `import labkit as lab`.

Importing this package is light. It sets the environment that ROS reads when it is loaded, and
loads the rest when a name is first used, so that it works in a bare Python too: that is how
`python3 -m labkit` sets up a fresh machine.
"""

from __future__ import annotations

import importlib
import sys
from types import ModuleType

from labkit.errors import LabError, LabTimeout, SetupError
from labkit.settings import prepare_environment

__version__ = '0.1.0'

# Public name -> the module that defines it.
_PUBLIC = {
    'start': 'labkit.background.runtime',
    'spin': 'labkit.background.runtime',
    'remove': 'labkit.background.runtime',
    'stop': 'labkit.background.runtime',
    'wait_until': 'labkit.background.waiting',
    'wait_for_message': 'labkit.background.waiting',
    'wait_for_subscribers': 'labkit.background.waiting',
    'listen': 'labkit.background.waiting',
    'graph': 'labkit.views.graph',
    'monitor': 'labkit.views.monitor',
    'plot': 'labkit.views.plot',
    'processes': 'labkit.background.child_processes',
    'Turtlebot': 'labkit.sim.turtlebot',
    'arena': 'labkit.views.arena',
    'teleop': 'labkit.views.teleop',
    'doctor': 'labkit.checkup.report',
    'lesson': 'labkit.exercises.lesson',
    'progress': 'labkit.exercises.progress',
}

# Reading one of these names starts ROS. In `lab.spin(Talker())` Python reads `lab.spin`, then
# builds the talker, which needs ROS, then calls; and after `lab.lesson(...)` a lesson makes nodes.
_START_ROS = ('lesson', 'spin')

__all__ = ['LabError', 'LabTimeout', *_PUBLIC]


def __getattr__(name: str) -> object:
    if name not in _PUBLIC:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    try:
        function = getattr(importlib.import_module(_PUBLIC[name]), name)
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


class _Package(ModuleType):
    """Keep public names apart from modules of the same name (`lab.doctor`, labkit/doctor.py).

    Importing a module makes Python set it as an attribute of its package, which would hide the
    public function.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _PUBLIC and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
prepare_environment()
if 'IPython' in sys.modules:
    importlib.import_module('labkit.ros2.magic').register()
