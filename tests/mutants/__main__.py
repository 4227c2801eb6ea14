"""Change the solutions of the exercises as a program would, and see what the checks say.

    python tests/mutants                    # all of them, in the course's folder: an hour or so
    python tests/mutants -k odds-ones       # those with this in their id
    python tests/mutants --sample 10        # every tenth
    python tests/mutants --list -k evens    # only show what would be run

A mutant may get PASS only if it does what the task asks for. Those that do, although they differ
from the solution, stand in `equivalent.json` with a reason; every other PASS is a false one, and
makes the exit code 1. So does a mutant that gets no verdict.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
ROOT = TESTS.parent
# The labkit beside these tests, also for the kernels; then `mutants`, then `proof`.
sys.path[:1] = [str(ROOT), str(TESTS), str(TESTS / 'lessons')]
os.environ['PYTHONPATH'] = os.pathsep.join([str(ROOT), os.environ.get('PYTHONPATH', '')])

if __name__ == '__main__':
    from mutants.main import main

    sys.exit(main(__doc__))
