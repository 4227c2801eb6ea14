"""What a task asks of a program that the learner runs in a terminal: its node is there now."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from labkit.exercises import words_of
from labkit.lessons._terminal import InATerminal
from labkit.lessons.package.content import Runs, Work, refuse_program

__all__ = ['Running']

WORDS = words_of(__file__)


@dataclass(frozen=True)
class Running(Runs):
    """A program of the package runs in a terminal, and its node is on the graph."""

    @property
    def text(self) -> str:
        """What is asked for."""
        told = WORDS.of(package=self.package, program=self.program, node=self.node)
        return told.clause('runs-in-a-terminal')

    def judge(self, work: Work) -> str:
        """Raise Fail unless it is there, started from what is built now."""
        if self.program not in work.programs:
            refuse_program(self.program, work)
        path = os.path.realpath(work.program(self.program))
        command = f'ros2 run {self.package} {self.program}'
        program = InATerminal(
            f'/{self.node}',
            command,
            start=f'In a terminal, in ros2_ws: source install/setup.bash, then {command}.',
            again='Then correct the file in src, build, and start it again.',
            source='src',
            is_mine=lambda process: self._is_mine(process, path),
            changed=lambda: work.changed,
            joins=True,
            has_to_answer=True,
        )
        program.find(work.probe)
        work.ran.append(self.program)
        return ''

    def _is_mine(self, process: Any, path: str) -> bool:
        """Tell whether it is the program, or a `ros2 run` that is about to become one."""
        words: Sequence[str] = process.info['cmdline'] or ()
        named = [word for word in words if word.endswith(f'/{self.package}/{self.program}')]
        starts = (self.package, self.program) in pairwise(words)
        return starts or path in map(os.path.realpath, named)
