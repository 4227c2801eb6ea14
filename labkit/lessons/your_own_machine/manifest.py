"""Exercise: a package.xml that names what the code imports."""

from __future__ import annotations

import sys

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked
from labkit.lessons.package.content import Built, InAWorkspace, Runs, Work, dependencies
from labkit.lessons.your_own_machine.made import COURIER

__all__ = ['exercise']

IMPORTED = ('rclpy', 'std_msgs', 'geometry_msgs')

MISSING = Mistake(
    'manifest/missing',
    'It runs here, because this machine has it. On another machine rosdep installs what '
    'package.xml names, and the import fails.',
    '<depend>{name}</depend> in package.xml, then build again.',
)
OF_PYTHON = Mistake(
    'manifest/of-python',
    'Python brings this module itself, and rosdep has no rule for it.',
    'Take {name} out of package.xml, then build again.',
)


def _names_imports(work: Work) -> None:
    missing = [name for name in IMPORTED if name not in dependencies(work)]
    if missing:
        raise Fail(
            'each package that courier.py imports, in package.xml',
            f'without {" and ".join(missing)}',
            MISSING.of(name=missing[0]),
        )


def _names_no_module(work: Work) -> None:
    wrong = [name for name in dependencies(work) if name in sys.stdlib_module_names]
    if wrong:
        raise Fail('names of packages in package.xml', wrong[0], OF_PYTHON.of(name=wrong[0]))


def _is_untouched(work: Work) -> bool:
    path = work.source / 'package.xml'
    return path.is_file() and not work.build.is_dir() and path.read_text().count('<depend>') == 1


exercise = Exercise(
    name='manifest',
    task='Let package.xml of courier_lab name what its code imports, and build it.',
    clauses=(
        Built(COURIER),
        Asked('its package.xml names each package that `courier.py` imports', _names_imports),
        Asked('it names no module that comes with Python', _names_no_module),
        Runs('courier', 'courier', COURIER),
    ),
    stage=InAWorkspace(COURIER, _is_untouched),
    hints=[
        'Read the lines of courier.py that begin with import or from.',
        'In from geometry_msgs.msg import Point, the package is geometry_msgs.',
        'Copy the line <depend>rclpy</depend>, once for each missing package. rosdep keys '
        '--from-paths src shows what is named. Then build.',
    ],
    answer=Solution(
        __file__,
        'manifest.ipy',
        'math comes with Python. The other three are packages of ROS, and one of them was named.',
    ),
)
