"""A check of what runs in the notebook's own event loop, such as an asyncio task.

That loop stands still while a cell runs, and with it the task. So the check goes on in a thread
after its cell has ended, and its verdict takes the place of the word 'checking'. Two checks at
once would take each other's clocks and probes, so each waits for those begun before it.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Generator
from typing import Any, ClassVar

from labkit.errors import LabError, cell_name
from labkit.exercises.verdict import Verdict
from labkit.views.card import Card

__all__ = ['Pending', 'learner_task_runs']

WORDS = (
    'A task of this notebook is at work, and it stands still while a cell runs. The check goes on '
    'when this cell has ended, and its answer will stand here. `await _` in the next cell waits '
    'for it.'
)


def learner_task_runs() -> bool:
    """Tell whether a task that a cell has started waits for the event loop of this thread."""
    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:
        return False
    current = asyncio.current_task(loop)
    return any(_is_of_cell(task) for task in asyncio.all_tasks(loop) if task is not current)


def _is_of_cell(task: asyncio.Task[Any]) -> bool:
    code = getattr(task.get_coro(), 'cr_code', None)
    return code is not None and bool(cell_name(code.co_filename))


class Pending:
    """A verdict that is about to come. In a notebook it shows itself as soon as it is there.

    Until then it is neither true nor false, and says so. Waiting would not help: the task that is
    judged would stand still meanwhile.

    Args:
        name: Name of the exercise.
        check: Returns the verdict. It is called in a thread.
        form: Returns a form that shows it, with buttons; None where there is none.
    """

    _last_begun: ClassVar[threading.Thread | None] = None

    def __init__(
        self, name: str, check: Callable[[], Verdict], form: Callable[[], Any] = lambda: None
    ) -> None:
        self._name = name
        self._form = form
        self._check = check
        self._verdict: Verdict | None = None
        self._handle: Any = None
        self._before: threading.Thread | None = None
        self._thread = threading.Thread(target=self._work, name='labkit check', daemon=True)

    @classmethod
    def wait_for_all(cls) -> None:
        """Wait until every check that goes on in a thread has ended."""
        if cls._last_begun is not None:
            cls._last_begun.join()

    def _begin(self) -> None:
        """Check after those that were begun before. Called in the thread that runs cells."""
        if self._thread.ident is None:
            self._before, Pending._last_begun = Pending._last_begun, self._thread
            self._thread.start()

    def _work(self) -> None:
        if self._before is not None:
            self._before.join()
        self._verdict = self._check()
        if self._handle is not None:
            self._handle.update(self._verdict)

    def _card(self) -> Card:
        return Card('quiet', 'CHECKING', self._name, text=WORDS)

    def __repr__(self) -> str:
        return repr(self._card() if self._verdict is None else self._verdict)

    def __bool__(self) -> bool:
        if self._verdict is None:
            raise LabError(
                f'The check of {self._name} has no verdict yet: a task of this notebook stands '
                'still while a cell runs.',
                todo=f'Wait for it: verdict = await lesson.{self._name}.check()',
            )
        return self._verdict.passed

    def _ipython_display_(self) -> None:
        from IPython.display import display

        self._handle = self._form()
        if self._handle is None:
            self._handle = display(self._card(), display_id=True)  # type: ignore[no-untyped-call]
        else:
            self._handle.show(self._card(), busy=True)
        self._begin()

    def show_in(self, form: Any) -> None:
        """Check, and let a form show the verdict."""
        self._handle = form
        self._begin()

    def __await__(self) -> Generator[Any, None, Verdict]:
        self._begin()
        return asyncio.to_thread(self._result).__await__()

    def _result(self) -> Verdict:
        self._thread.join()
        assert self._verdict is not None
        return self._verdict
