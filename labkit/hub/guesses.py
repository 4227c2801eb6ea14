"""How fast passwords may be guessed: attempts for an account wait for each other, and then longer.

Nobody is locked out. Attempts for one account come one after the other, and after some wrong ones
each waits before it is looked at. Who has logged in before with the same browser has a lane of
their own, so guesses of others do not hold them up, even from the same address: a class often has
one for all.
"""

from __future__ import annotations

import asyncio
import time
from collections import Counter, OrderedDict
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from weakref import WeakValueDictionary

__all__ = ['Guesses', 'TooManyError']

# Wrong passwords before one has to wait: for an account, and from an address, where a class of
# thirty may begin at once; and the longest wait, s.
_ACCOUNT, _ADDRESS = (5, 8.0), (100, 4.0)
# After so long without another one, wrong passwords are forgotten, s.
_FORGOTTEN_SEC = 900.0
# How many attempts from one address may wait for one account.
_WAITING = 3
# What is kept at most: each attempt may bring another name.
_KEPT = 10_000

_Key = tuple[str, ...]


class TooManyError(Exception):
    """So many attempts for this account are waiting that another one can't."""


class Guesses:
    """Attempts to log in, and how many of late were wrong.

    Args:
        sleep: Waits for some seconds.
    """

    def __init__(self, sleep: Callable[[float], Awaitable[None]] = asyncio.sleep) -> None:
        self._sleep = sleep
        # Key -> number of wrong passwords, and when the last one came; the oldest first.
        self._wrong: OrderedDict[_Key, tuple[int, float]] = OrderedDict()
        self._lanes: WeakValueDictionary[_Key, asyncio.Lock] = WeakValueDictionary()
        self._waiting: Counter[_Key] = Counter()

    @asynccontextmanager
    async def turn(self, name: str, address: str, *, known: bool) -> AsyncIterator[None]:
        """Wait until an attempt may be looked at; the next one for its account comes after it.

        Args:
            name: Whose password is tried.
            address: Where the attempt comes from.
            known: Whether this browser has shown the right password before.

        Raises:
            TooManyError: Too many are waiting.
        """
        key, place = _keys(name, address, known)
        if self._waiting[place] >= _WAITING:
            raise TooManyError
        self._waiting[place] += 1
        try:
            lane = self._lanes.setdefault(key, asyncio.Lock())
            async with lane:
                wait = self._wait(key, _ACCOUNT)
                await self._sleep(wait if known else wait + self._wait((address,), _ADDRESS))
                yield
        finally:
            self._waiting[place] -= 1
            if not self._waiting[place]:
                del self._waiting[place]

    def note_wrong(self, name: str, address: str, *, known: bool) -> None:
        """Note that an attempt was wrong; see `turn`."""
        now = time.monotonic()
        for key in (_keys(name, address, known)[0], (address,)):
            self._wrong[key] = self._count(key) + 1, now
            self._wrong.move_to_end(key)
        while (
            len(self._wrong) > _KEPT or next(iter(self._wrong.values()))[1] < now - _FORGOTTEN_SEC
        ):
            self._wrong.popitem(last=False)

    def _wait(self, key: _Key, limits: tuple[int, float]) -> float:
        free, longest = limits
        more = self._count(key) - free
        return min(2.0**more, longest) if more >= 0 else 0.0

    def _count(self, key: _Key) -> int:
        count, last = self._wrong.get(key, (0, 0.0))
        return count if time.monotonic() < last + _FORGOTTEN_SEC else 0


def _keys(name: str, address: str, known: bool) -> tuple[_Key, _Key]:
    """Return the keys of the lane of an attempt, and of its place in it."""
    lane = (name, 'known' if known else 'unknown')
    return lane, (*lane, '' if known else address)
