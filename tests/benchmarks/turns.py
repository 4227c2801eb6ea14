"""Things to compare take turns, so that what else the machine does hits all of them alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

__all__ = ['Figures', 'take_turns']

Figures = dict[str, float]
# Ratios of two turns that are no further apart tell what a third one would.
SAME = 0.1


def take_turns(
    ways: Mapping[str, Callable[[], Figures]], keys: Sequence[str], most: int
) -> dict[str, list[Figures]]:
    """Measure all ways, in another order each time, until their ratios have settled.

    Args:
        ways: What is compared, by name; ratios are to the first one.
        keys: The figures whose ratios must have settled: the last two within a tenth.
        most: So many turns are enough, whether they have or not.

    Returns:
        The figures of each way, one for each turn.
    """
    names = list(ways)
    seen: dict[str, list[Figures]] = {name: [] for name in names}
    for turn in range(most):
        first = turn % len(names)
        for name in names[first:] + names[:first]:
            seen[name].append(ways[name]())
        if turn and _settled(seen, keys):
            break
    return seen


def _settled(seen: Mapping[str, Sequence[Figures]], keys: Sequence[str]) -> bool:
    base, *others = seen.values()
    return all(
        abs(other[-1][key] * base[-2][key] - other[-2][key] * base[-1][key])
        <= SAME * abs(other[-2][key] * base[-1][key])
        for other in others
        for key in keys
    )
