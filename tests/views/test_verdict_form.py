"""A verdict with its buttons, without a page: what is shown, asked and refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from labkit import settings
from labkit.exercises import Exercise, Outcome
from labkit.exercises.verdict import Verdict
from labkit.views import verdict_form
from labkit.views.card import Card
from labkit.views.verdict_form import VerdictForm

FAIL = Verdict(Outcome.FAIL, 'ones', expected='1', seen='2', todo='Send `1`.')
PASS = Verdict(Outcome.PASS, 'ones', text='It does.')


class Answers:
    """An exercise that answers as it is told."""

    def __init__(self, *verdicts: Verdict) -> None:
        self.hints: Sequence[str] = ('Look.', 'Look closely.')
        self.seen = 0
        self.verdicts = list(verdicts)
        self.words = ''

    @property
    def may_solve(self) -> bool:
        return self.seen >= len(self.hints)

    def told_hint(self, number: int) -> Card:
        self.seen = max(self.seen, number)
        return Card('info', f'HINT {number} of 2', 'ones', text=self.hints[number - 1])

    def told_solution(self) -> Card:
        return Card('info', 'SOLUTION', 'ones', code='send(1)')

    def check_again(self, form: VerdictForm) -> str:
        form.update(self.verdicts.pop(0))
        return ''

    def refusal(self) -> str:
        return self.words


@pytest.fixture(autouse=True)
def between_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verdict_form, 'call_in_kernel', lambda function: function())


def shown(form: VerdictForm) -> dict[str, str]:
    """Return what JupyterLab draws above the buttons."""
    (output,) = form._output.outputs
    data: dict[str, str] = output['data']
    return data


def press(form: VerdictForm, ask: Any) -> None:
    form._handle_custom_msg({'ask': ask}, [])


def started(*verdicts: Verdict) -> tuple[VerdictForm, Answers]:
    answers = Answers(*verdicts)
    form = VerdictForm(answers)
    form.show(FAIL)
    return form, answers


def test_hints_come_one_by_one_and_then_the_solution(capsys: pytest.CaptureFixture[str]) -> None:
    form, _ = started()
    assert 'FAIL: ones' in capsys.readouterr().out  # without IPython it is printed
    assert (form.count, form.told, form.solves) == (2, 0, False)
    press(form, 'solution')  # not yet
    press(form, 'hint')
    assert shown(form)['text/plain'] == f'{FAIL!r}\nHINT 1 of 2: ones\n  Look.'
    assert (form.told, form.solves, form.words) == (1, False, 'Hint 1 of 2 is above.')
    press(form, 'hint')
    press(form, 'hint')  # there are no more
    assert (form.told, form.solves) == (2, True)
    for _ in range(2):
        press(form, 'solution')
    assert shown(form)['text/plain'].count('SOLUTION: ones') == 1
    assert shown(form)['text/html'].count('<div role="status"') == 4
    assert form.heard == 6


def test_a_new_verdict_takes_the_place_of_the_old_one() -> None:
    other = Verdict(Outcome.FAIL, 'ones', expected='1', seen='3')
    form, _ = started(FAIL, other, PASS)
    press(form, 'hint')
    press(form, 'check')
    assert (form.words, form.done, form.busy) == ('FAIL, as before.', False, False)
    press(form, 'check')
    assert form.words == 'FAIL.'
    assert shown(form)['text/plain'] == f'{other!r}\nHINT 1 of 2: ones\n  Look.'
    press(form, 'check')
    assert (form.words, form.done) == ('PASS.', True)
    assert shown(form)['text/plain'] == repr(PASS)
    press(form, 'check')  # there is no button for it any more
    assert shown(form)['text/plain'] == repr(PASS)


def test_a_check_that_can_not_be_is_refused_in_words() -> None:
    form, answers = started()
    answers.words = 'A cell is running.'
    press(form, 'check')
    assert (form.words, form.busy) == ('A cell is running.', False)
    assert shown(form)['text/plain'] == repr(FAIL)


def test_a_verdict_that_is_about_to_come_can_not_be_asked_for_again() -> None:
    form = VerdictForm(Answers())
    form.show(Card('quiet', 'CHECKING', 'ones'), busy=True)
    press(form, 'check')
    assert form.busy and shown(form)['text/plain'] == 'CHECKING: ones'
    form.update(FAIL)
    assert not form.busy and form.words == 'FAIL.'


@pytest.mark.parametrize('ask', [None, 1, ['hint'], 'more'])
def test_a_message_that_is_none_of_the_buttons_changes_nothing(ask: Any) -> None:
    form, _ = started()
    press(form, ask)
    assert (form.told, form.words, shown(form)['text/plain']) == (0, '', repr(FAIL))


def test_what_is_stored_is_the_card_without_buttons() -> None:
    form, _ = started()
    press(form, 'hint')
    page = form._stored._bundle()
    assert page['text/plain'] == shown(form)['text/plain']
    assert shown(form)['text/html'] in page['text/html']
    assert '<button' not in page['text/html'] and 'Stored on' not in page['text/html']


def test_only_a_verdict_that_leaves_something_to_do_has_a_form(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    exercise = Exercise(name='ones', task='Send 1.')
    for audience, verdict, has in (
        (settings.LEARNER, FAIL, True),
        (settings.LEARNER, PASS, False),
        (settings.RECORDING, FAIL, False),
        (settings.TERMINAL, FAIL, False),
    ):
        monkeypatch.setattr(settings, 'audience', lambda to=audience: to)
        formed = replace(verdict, form=exercise._form)
        assert formed == verdict
        if has:
            formed._ipython_display_()
        else:
            with pytest.raises(NotImplementedError):
                formed._ipython_display_()
