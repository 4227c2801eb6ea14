"""What came of all mutants: a table for people, and the same as data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mutants.generate import equivalents
from mutants.run import Result

__all__ = ['as_data', 'false_passes', 'report']

_HEAD = f'{"":24}{"mutants":>9}{"no PASS":>9}{"specific":>10}{"PASS right":>12}{"false PASS":>12}'


def report(results: Sequence[Result]) -> str:
    """Return a table, a line an exercise and a lesson, and below it what has to be looked at."""
    lines, lessons = [_HEAD], dict.fromkeys(_lesson(result) for result in results)
    for lesson in lessons:
        own = [result for result in results if _lesson(result) == lesson]
        lines.append(_row(lesson, own))
        for exercise in dict.fromkeys(result.mutant.exercise for result in own):
            part = [result for result in own if result.mutant.exercise == exercise]
            lines.append(_row(f'  {exercise.partition("-")[2]}', part))
    lines.append(_row('all', results))
    lines += _listed('False PASS', false_passes(results))
    lines += _listed('Equivalent, but no PASS', [r for r in results if _refused(r)])
    lines += _listed('No verdict', [r for r in results if r.finding.outcome is None])
    lines += _listed('After these the solution does not pass', [r for r in results if r.spoils])
    return '\n'.join(lines)


def false_passes(results: Sequence[Result]) -> list[Result]:
    """Return those that passed and should not have."""
    return [result for result in results if result.passed and not _reason(result)]


def as_data(results: Sequence[Result]) -> list[dict[str, Any]]:
    """Return the results as plain data, for a JSON file."""
    return [
        {
            'id': result.mutant.id,
            'diff': result.mutant.diff,
            'outcome': result.finding.outcome.value if result.finding.outcome else None,
            'equivalent': _reason(result),
            'specific': result.is_specific,
            'seconds': round(result.finding.seconds, 2),
            'text': result.finding.text,
            'spoils': result.spoils,
        }
        for result in results
    ]


def _row(name: str, results: Sequence[Result]) -> str:
    others = [result for result in results if not result.passed and not _reason(result)]
    share = sum(result.is_specific for result in others) / len(others) if others else 1.0
    right = sum(result.passed for result in results) - len(false_passes(results))
    return (
        f'{name:24}{len(results):9}{len(others):9}{share:10.0%}{right:12}'
        f'{len(false_passes(results)):12}'
    )


def _listed(title: str, results: Sequence[Result]) -> list[str]:
    if not results:
        return []
    lines = ['', f'{title}: {len(results)}']
    for result in results:
        lines += [f'  {result.mutant.id}', f'      {result.mutant.diff}']
        if not result.passed:
            lines.append(f'      {result.finding.text[:200]}')
        if result.spoils:
            lines.append(f'      afterwards: {result.spoils[:200]}')
    return lines


def _lesson(result: Result) -> str:
    return result.mutant.exercise.partition('-')[0]


def _reason(result: Result) -> str:
    return equivalents().get(result.mutant.exercise, {}).get(result.mutant.diff, '')


def _refused(result: Result) -> bool:
    return not result.passed and bool(_reason(result))
