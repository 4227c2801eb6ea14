"""All benchmarks: prints tables, judges nothing.

    .venv/bin/python tests/benchmarks                # some 5 minutes, on a machine that is idle
    .venv/bin/python tests/benchmarks messages sim   # some of them
    .venv/bin/python tests/benchmarks soak           # one of those that are only run by name
    .venv/bin/python tests/benchmarks --quick        # does it run at all?

A table has a figure, the target that the course has set itself, and whether it is met. What is
compared takes turns, until two turns in a row have the same ratio; so a busy machine takes longer.
"""

from __future__ import annotations

import argparse
import importlib
import os
import platform
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Variables that would make what is measured behave otherwise than in a fresh terminal.
FOREIGN = ('PYTEST_', 'ROS_', 'RMW_', 'RCUTILS_', 'JPY_', 'LABKIT_')
# Name -> module, its function, what it measures.
BENCHES = {
    'messages': ('bench_messages', 'tables', "labkit's background thread beside rclpy.spin"),
    'process': ('bench_process', 'tables', 'a kernel at rest, and how long starting takes'),
    'ros2': ('bench_ros2', 'tables', 'how soon %ros2 and ros2 answer'),
    'views': ('bench_views', 'tables', 'monitor and plot at 1,000 messages a second'),
    'course': ('bench_course', 'tables', 'labkit lab the second time, labkit test --fast'),
    'bags': ('bench_bags', 'tables', 'recording beside a bare subscription'),
    'sim': ('bench_sim', 'tables', 'the robot: alone, with its arena, in quick time'),
    'transforms': ('bench_transforms', 'tables', 'lookups, and a thousand transforms a second'),
}
# Longer, so only when named.
LONG = {
    'class': ('bench_class', 'tables', 'a class on one server, see docs/scale.md'),
    'soak': ('bench_soak', 'tables', 'a million messages, ten thousand nodes: what is left'),
    'lessons': ('bench_course', 'lessons', 'how long the test of each lesson takes'),
    'setup': ('bench_course', 'setup', 'the first start beside pip; both fetch from the network'),
}


def main() -> int:
    """Print the tables."""
    options = _parser().parse_args()
    try:
        from table import show

        benches = {**BENCHES, **LONG}
        chosen = {name: benches[name] for name in options.names or BENCHES}
        modules = {name: importlib.import_module(module[0]) for name, module in chosen.items()}
    except ModuleNotFoundError as error:
        print(
            f'{sys.executable} has no {error.name}. Run it with the environment of the course:\n'
            '.venv/bin/python tests/benchmarks   (`python3 -m labkit test --fast` makes it)',
            file=sys.stderr,
        )
        return 2
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
    for name, (_, function, _) in chosen.items():
        begin = time.monotonic()
        for title, rows in getattr(modules[name], function)(options.quick):
            show(title, rows)
        print(f'\n({name} took {time.monotonic() - begin:.0f} s)', flush=True)
    return 0


def _parser() -> argparse.ArgumentParser:
    lists = [
        f'{title}:\n' + '\n'.join(f'  {name:<10}{what}' for name, (*_, what) in benches.items())
        for title, benches in (('benchmarks', BENCHES), ('only when named', LONG))
    ]
    parser = argparse.ArgumentParser(
        prog='.venv/bin/python tests/benchmarks',
        description=__doc__,
        epilog='\n\n'.join(lists),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument('--quick', action='store_true', help='only to see whether it runs')
    parser.add_argument(
        'names',
        nargs='*',
        choices=[[], *BENCHES, *LONG],
        metavar='name',
        help='what to measure; all of the first list below if there is none',
    )
    return parser


if __name__ == '__main__':
    sys.path.insert(1, str(ROOT))
    sys.exit(main())
