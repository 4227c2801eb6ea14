"""The command line of the mutants."""

from __future__ import annotations

import argparse
import json
import sys
import threading
import time
from collections.abc import Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor
from pathlib import Path

from mutants.generate import Mutant, equivalents, mutants_of
from mutants.report import as_data, false_passes, report
from mutants.run import Result, run_mutants

from labkit.exercises import Exercise, Lesson
from labkit.exercises.found_lessons import all_lessons

__all__ = ['main']

Part = tuple[Lesson, Exercise, list[Mutant]]
# So many mutants share a kernel, so that no job is left alone with an exercise of two hundred.
PART = 60


def main(description: str | None) -> int:
    """Run what the command line asks for; return the exit code."""
    parser = argparse.ArgumentParser(
        'python tests/mutants',
        description=description,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        '-k', nargs='+', default=[''], metavar='TEXT', help='only those with one in their id'
    )
    parser.add_argument('--jobs', type=int, default=2, metavar='N', help='kernels at a time (2)')
    parser.add_argument('--sample', type=int, default=1, metavar='N', help='every Nth of them')
    parser.add_argument('--list', action='store_true', help='show them and run nothing')
    parser.add_argument('--json', type=Path, metavar='FILE', help='where to write all verdicts')
    options = parser.parse_args()
    parts = _chosen(options.k, options.sample)
    if options.list:
        for _, _, mutants in parts:
            for mutant in mutants:
                reason = equivalents().get(mutant.exercise, {}).get(mutant.diff)
                print(f'{mutant.id}: {mutant.diff}', *([f'({reason})'] if reason else []))
        return 0
    results = _run(parts, options.jobs)
    if options.json:
        options.json.write_text(json.dumps(as_data(results), indent=1), encoding='utf-8')
    print(report(results))
    no_verdict = any(result.finding.outcome is None for result in results)
    return 1 if no_verdict or false_passes(results) else 0


def _chosen(texts: Sequence[str], sample: int) -> list[Part]:
    parts, count = [], 0
    for lesson in all_lessons():
        for exercise in lesson.exercises:
            found = mutants_of(lesson, exercise)
            named = [mutant for mutant in found if any(text in mutant.id for text in texts)]
            chosen = [m for i, m in enumerate(named, start=count) if i % sample == 0]
            count += len(named)
            for first in range(0, len(chosen), PART):
                parts.append((lesson, exercise, chosen[first : first + PART]))
    return parts


def _run(parts: Sequence[Part], jobs: int) -> list[Result]:
    """Run all parts, the long ones first, `jobs` at a time; return the results in their order.

    The stop key (Ctrl and C) ends it early; what has been found until then is returned.
    """
    order = [mutant.id for *_, mutants in parts for mutant in mutants]
    results: dict[str, Result] = {}
    start, stopping = time.monotonic(), threading.Event()

    def say(result: Result) -> None:
        if stopping.is_set():
            raise CancelledError
        results[result.mutant.id] = result
        outcome = result.finding.outcome.value if result.finding.outcome else 'no verdict'
        minutes = (time.monotonic() - start) / 60
        line = f'{len(results)} of {len(order)}, {minutes:.1f} min: {outcome} {result.mutant.id}'
        print(line, file=sys.stderr, flush=True)

    with ThreadPoolExecutor(max_workers=jobs) as pool:
        longest_first = sorted(parts, key=lambda part: -len(part[2]))
        running = [pool.submit(lambda part: run_mutants(*part, say), p) for p in longest_first]
        try:
            for future in running:
                future.result()
        except KeyboardInterrupt:
            stopping.set()
            pool.shutdown(cancel_futures=True)
    return [results[name] for name in order if name in results]
