"""Torture notebooks for long, and say in figures what was left standing.

python tests/torture                 # all trials: an hour or so
python tests/torture shuffled wild   # some of them
python tests/torture --seed 3        # other chance
python tests/torture --small         # a few minutes
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:1] = [str(TESTS.parent), str(TESTS)]


def main() -> int:
    """Run trials; return the exit code."""
    from torture.trials import TRIALS

    parser = argparse.ArgumentParser(prog='tests/torture', description=__doc__)
    parser.add_argument('names', nargs='*', help=', '.join(TRIALS))
    parser.add_argument('--seed', type=int, default=7)
    parser.add_argument('--small', action='store_true')
    options = parser.parse_args()
    done = [run(name, options.seed, large=not options.small) for name in options.names or TRIALS]
    return int(not all(done))


def run(name: str, seed: int, *, large: bool) -> bool:
    """Run one trial and print its figures; return whether it was stood."""
    from conftest import _FOREIGN, Kernel
    from torture.trials import TRIALS, Bench

    own = {name: value for name, value in os.environ.items() if not name.startswith(_FOREIGN)}
    kernels: list[Kernel] = []

    def start(**env: str) -> Kernel:
        folder = Path(place, str(len(kernels)))
        folder.mkdir()
        common = {
            'PYTHONPATH': str(TESTS.parent),
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'OFF',
            'LABKIT_HOME': str(Path(place, 'home')),
            'IPYTHONDIR': str(folder / 'ipython'),
        }
        kernels.append(Kernel(folder, {**own, **common, **env}))
        return kernels[-1]

    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix='labkit-torture-') as place:
        try:
            result = TRIALS[name](Bench(start, random.Random(seed), large=large))
        except BaseException as error:
            result = f'FAILED: {error}'
        for kernel in kernels:
            kernel.process.kill()
    print(f'{name:<10} {time.monotonic() - begin:6.0f} s  {result}', flush=True)
    return not result.startswith('FAILED')


if __name__ == '__main__':
    sys.exit(main())
