"""Sleeping tells how late the machine is, and a time that is held up as others are."""

from __future__ import annotations

import ctypes
import time

from labkit.exercises.naps import NAP_SEC, Naps


def sleep_until(naps: Naps, seconds: float) -> None:
    while naps.seconds < seconds:
        time.sleep(0.001)


def test_it_never_sleeps_shorter_than_it_says() -> None:
    naps = Naps()
    assert (naps.seconds, naps.slowness, naps.late) == (0.0, 1.0, 0.0)
    began = time.monotonic()
    with naps:
        sleep_until(naps, 3 * NAP_SEC)
        told, slowness = naps.seconds, naps.slowness
    assert time.monotonic() - began >= told * slowness >= told >= 3 * NAP_SEC


def test_what_holds_up_all_threads_holds_up_its_time() -> None:
    with Naps() as naps:
        sleep_until(naps, 2 * NAP_SEC)
        # Without giving Python's lock back, as no other thread can run then.
        ctypes.PyDLL(None).usleep(int(12 * NAP_SEC * 1e6))
        sleep_until(naps, naps.seconds + 2 * NAP_SEC)
    naps._thread.join(60)
    lost = naps.seconds * (naps.slowness - 1)
    # One nap lasted twelve times as long. The tenth that was held up least tells nothing of it.
    assert lost >= 10 * NAP_SEC
    assert 2 * naps.late <= lost


def test_it_ends_with_its_block() -> None:
    with Naps() as naps:
        sleep_until(naps, NAP_SEC)
    naps._thread.join(60)
    assert not naps._thread.is_alive()
