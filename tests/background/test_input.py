"""`input()` is answered when nobody is there to type."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

CODE = """
import labkit as lab

lab.start()
"""
ASK = "text = input('Your message: ') or 'Hello'\nprint(text)"


def test_a_program_presses_enter(start_kernel: Callable[..., Any]) -> None:
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run(CODE)
    assert kernel.run(ASK).text == 'Your message: \nHello\n'


def test_a_person_is_asked(start_kernel: Callable[..., Any]) -> None:
    kernel = start_kernel()
    kernel.run(CODE)
    # This client of the kernel says that it has no keyboard, and the kernel asks it all the same.
    assert 'StdinNotImplementedError' in str(kernel.run(ASK).error)
