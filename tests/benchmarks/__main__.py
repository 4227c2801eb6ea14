"""All benchmarks: `python tests/benchmarks` in the course's folder. Prints tables; judges nothing.

    python tests/benchmarks                      # some 5 minutes, on a machine that is idle
    python tests/benchmarks messages process     # some: messages process ros2 views bags sim ...
    python tests/benchmarks soak                 # a million messages, ten thousand nodes
    python tests/benchmarks lessons setup        # each lesson's test; the first start beside pip
    python tests/benchmarks --quick              # does it run at all?

A table has a figure, the target that the course has set itself, and whether it is met.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
from pathlib import Path

import bench_bags
import bench_course
import bench_messages
import bench_process
import bench_ros2
import bench_soak
import bench_views
from table import show

ROOT = Path(__file__).resolve().parents[2]
# Variables that would make what is measured behave otherwise than in a fresh terminal.
FOREIGN = ('PYTEST_', 'ROS_', 'RMW_', 'RCUTILS_', 'JPY_', 'LABKIT_')
BENCHES = {
    'messages': bench_messages.tables,
    'process': bench_process.tables,
    'ros2': bench_ros2.tables,
    'views': bench_views.tables,
    'course': bench_course.tables,
    'bags': bench_bags.tables,
}
# Longer, so only when named.
LONG = {
    'soak': bench_soak.tables,
    'lessons': bench_course.lessons,
    'setup': bench_course.setup,
}


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument('--quick', action='store_true', help='only to see whether it runs')
    parser.add_argument('names', nargs='*', choices=[[], *BENCHES, 'sim', *LONG], metavar='name')
    options = parser.parse_args()
    for name in [name for name in os.environ if name.startswith(FOREIGN)]:
        del os.environ[name]
    path = [str(ROOT), *filter(None, [os.environ.get('PYTHONPATH')])]
    os.environ.update(
        PYTHONPATH=os.pathsep.join(path),
        ROS_AUTOMATIC_DISCOVERY_RANGE='OFF',
        PYTHONUNBUFFERED='1',
    )
    load = os.getloadavg()[0]
    print(
        f'Python {platform.python_version()}, {os.cpu_count()} cores, load {load:.1f}'
        f'{" (busy: figures are worse than on an idle machine)" if load > 0.5 else ""}'
    )
    names = options.names or [*BENCHES, 'sim']
    for name in names:
        if name in {**BENCHES, **LONG}:
            for title, rows in {**BENCHES, **LONG}[name](options.quick):
                show(title, rows)
    if 'sim' not in names:
        return 0
    print('\n== The simulated robot', flush=True)
    command = [sys.executable, str(Path(__file__).with_name('bench_sim.py'))]
    return subprocess.run([*command, *(['--quick'] if options.quick else [])]).returncode


if __name__ == '__main__':
    sys.exit(main())
