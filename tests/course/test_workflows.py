"""What continuous integration runs: the gate on each push, everything every night."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from labkit.course import run_tests
from labkit.setup.machine import VERSIONS

ROOT = Path(__file__).resolve().parents[2]


GATE, EVERYTHING = 'test.yml', 'everything.yml'


def workflow(name: str) -> dict[Any, Any]:
    return yaml.safe_load((ROOT / '.github' / 'workflows' / name).read_text())


def commands(name: str) -> list[str]:
    (job,) = workflow(name)['jobs'].values()
    return [step['run'] for step in job['steps'] if 'run' in step]


@pytest.mark.parametrize('name', [GATE, EVERYTHING])
def test_each_python_of_the_course_is_tried(name: str) -> None:
    (job,) = workflow(name)['jobs'].values()
    versions = ['{}.{}'.format(*version) for version in sorted(VERSIONS)]
    assert job['strategy']['matrix']['python'] == versions


def test_gate_runs_on_each_push_and_everything_every_night() -> None:
    assert commands(GATE) == ['bash .ci/run']
    assert workflow(EVERYTHING)[True].keys() == {'schedule', 'workflow_dispatch'}
    assert commands(EVERYTHING) == ['bash .ci/run --all --junitxml=report.xml']


def test_a_pull_request_runs_once() -> None:
    gate = workflow(GATE)
    events = gate[True]  # YAML 1.1 reads `on` as a truth value
    assert events['push'] == {'branches': ['main']}
    assert 'pull_request' in events
    assert gate['concurrency']['group'] == 'test-${{ github.ref }}'


def test_downloads_are_kept() -> None:
    for name in (GATE, EVERYTHING):
        (job,) = workflow(name)['jobs'].values()
        (cache,) = [step['with'] for step in job['steps'] if 'cache' in step.get('uses', '')]
        assert all(name in cache['key'] for name in run_tests.REQUIREMENTS)


def test_hooks_are_the_quick_checks() -> None:
    hooks = yaml.safe_load((ROOT / '.pre-commit-config.yaml').read_text())['repos']
    assert [one['repo'] for one in hooks] == ['local']
    entries = {hook['name']: hook['entry'].split() for hook in hooks[0]['hooks']}
    prefix = ['.venv/bin/python', '-m']
    assert entries == {name: [*prefix, *command] for name, command in run_tests._fast_steps()}


@pytest.mark.parametrize('path', sorted((ROOT / '.github').rglob('*.yml')), ids=lambda p: p.name)
def test_files_for_github_can_be_read(path: Path) -> None:
    content = yaml.safe_load(path.read_text())
    if path.parent.name == 'ISSUE_TEMPLATE' and path.name != 'config.yml':
        ids = [part['id'] for part in content['body']]
        assert len(ids) == len(set(ids))
        assert {'name', 'description', 'body'} <= set(content)


def test_bug_reports_ask_for_what_the_doctor_says() -> None:
    text = (ROOT / '.github' / 'ISSUE_TEMPLATE' / 'bug.yml').read_text()
    (doctor,) = [part for part in yaml.safe_load(text)['body'] if part['id'] == 'doctor']
    assert '`python3 -m labkit doctor`' in doctor['attributes']['label']
    assert doctor['validations'] == {'required': True}
