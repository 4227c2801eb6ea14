"""Variants of exercises: each learner's numbers and names, and where they are shown."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from labkit import settings
from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.variants import variants_card

ROOT = Path(__file__).resolve().parents[2]
VARIED = [
    exercise for lesson in all_lessons() for exercise in lesson.exercises if exercise.variants
]
TASKS = (
    'import json\n'
    'from labkit.exercises.found_lessons import all_lessons\n'
    'print(json.dumps([e.task for l in all_lessons() for e in l.exercises if e.variants]))'
)


def tasks(env: dict[str, str]) -> list[str]:
    done = subprocess.run(
        [sys.executable, '-c', TASKS],
        cwd=ROOT,
        env={'PATH': '/usr/bin:/bin', **env},
        capture_output=True,
        text=True,
        check=True,
    )
    found: list[str] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize(
    ('variables', 'seed'),
    [
        ({}, ''),
        ({'LABKIT_VARIANT': ' anna '}, 'anna'),
        ({'JUPYTERHUB_USER': 'ben'}, ''),
        ({'JUPYTERHUB_USER': 'ben', 'LABKIT_VARIANTS': '0'}, ''),
        ({'JUPYTERHUB_USER': 'ben', 'LABKIT_VARIANTS': '1'}, 'ben'),
        ({'JUPYTERHUB_USER': 'ben', 'LABKIT_VARIANTS': '1', 'LABKIT_VARIANT': 'anna'}, 'anna'),
    ],
)
def test_whose_variant_it_is(
    monkeypatch: pytest.MonkeyPatch, variables: dict[str, str], seed: str
) -> None:
    for name in ('LABKIT_VARIANT', 'LABKIT_VARIANTS', 'JUPYTERHUB_USER'):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert settings.variant_seed() == seed


@pytest.mark.slow('goes through the whole course')
def test_same_seed_same_tasks_and_none_the_usual_ones() -> None:
    assert len(VARIED) >= 5
    usual, anna = tasks({}), tasks({'LABKIT_VARIANT': 'anna'})
    assert usual == [exercise.variants.usual.task for exercise in VARIED if exercise.variants]
    assert anna == tasks({'LABKIT_VARIANTS': '1', 'JUPYTERHUB_USER': 'anna'})
    assert not set(anna) & set(usual)


def test_the_numbers_are_in_all_that_the_learner_is_told() -> None:
    for exercise in VARIED:
        assert exercise.variants is not None
        mine = exercise.variants.of('anna')
        values = exercise.variants.values('anna')
        told = mine.task + ''.join(clause.text for clause in mine.clauses) + mine.answer.code
        for value in values.values():
            for part in value if isinstance(value, tuple) else [value]:
                assert str(part).removesuffix('.0') in told, (mine.name, part)
        assert [clause.text for clause in mine.clauses] != [
            clause.text for clause in exercise.variants.usual.clauses
        ]
        assert mine.answer.code != exercise.variants.usual.answer.code


def test_card_of_a_lesson_is_there_only_with_variants() -> None:
    assert variants_card(VARIED) is None
    mine = [exercise.variants.of('<b>anna') for exercise in VARIED if exercise.variants]
    card = variants_card(mine)
    assert card is not None
    text = repr(card)
    assert text.startswith('YOUR VARIANT: <b>anna')
    assert all(exercise.name in text for exercise in mine)
    assert '<b>anna' not in card._repr_html_()
