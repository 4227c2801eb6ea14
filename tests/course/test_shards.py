"""What continuous integration runs: each test once, in a part of its own, quick checks first."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import yaml

from labkit.course import run_tests
from labkit.setup.machine import VERSIONS

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope='module')
def workflow() -> dict[Any, Any]:
    text = (ROOT / '.github' / 'workflows' / 'test.yml').read_text()
    return yaml.safe_load(text)


def commands(job: dict[str, Any]) -> list[str]:
    return [step['run'] for step in job['steps'] if 'run' in step]


def chosen(words: list[str]) -> set[str]:
    """Return the notebooks and files of tests that pytest finds with some paths and --ignore."""
    ignored = [word.removeprefix('--ignore=') for word in words if word.startswith('--ignore=')]
    paths = [word for word in words if not word.startswith('-')]
    return {
        name
        for name in files()
        if any(f'{name}/'.startswith(f'{path}/') for path in paths)
        and not any(f'{name}/'.startswith(f'{path}/') for path in ignored)
    }


def files() -> list[str]:
    found = [*(ROOT / 'tests').rglob('test_*.py'), *(ROOT / 'notebooks').glob('*.ipynb')]
    return sorted(str(path.relative_to(ROOT)) for path in found)


def test_each_file_is_in_exactly_one_part(workflow: dict[Any, Any]) -> None:
    parts = workflow['jobs']['test']['strategy']['matrix']['shard']
    count = Counter(chosen(list(run_tests._FAST_TESTS)))
    for part in parts:
        ((_, command),) = run_tests._steps(shard=part)
        words = command[len([*run_tests._PYTEST, *run_tests._PARALLEL]) :]
        assert chosen(words), f'{part} is empty'
        count.update(chosen(words))
    assert len(files()) > 50
    wrong = {name: count[name] for name in files() if count[name] != 1}
    assert not wrong, 'file: number of parts that it is in'


def test_each_part_of_the_command_is_a_job(workflow: dict[Any, Any]) -> None:
    job = workflow['jobs']['test']
    assert sorted(job['strategy']['matrix']['shard']) == sorted(run_tests.SHARDS)
    assert commands(job) == ['bash .ci/run --shard ${{ matrix.shard }}']
    for paths in run_tests.SHARDS.values():
        assert all((ROOT / path).is_dir() for path in paths)


def test_each_python_of_the_course_is_tried(workflow: dict[Any, Any]) -> None:
    versions = ['{}.{}'.format(*version) for version in sorted(VERSIONS)]
    assert workflow['jobs']['test']['strategy']['matrix']['python'] == versions


def test_quick_checks_come_first(workflow: dict[Any, Any]) -> None:
    assert commands(workflow['jobs']['fast']) == ['python3 -m labkit test --fast']
    assert workflow['jobs']['test']['needs'] == 'fast'


def test_a_pull_request_runs_once(workflow: dict[Any, Any]) -> None:
    events = workflow[True]  # YAML 1.1 reads `on` as a truth value
    assert events['push'] == {'branches': ['main']}
    assert 'pull_request' in events
    assert workflow['concurrency']['group'] == 'test-${{ github.ref }}'


def test_downloads_are_kept(workflow: dict[Any, Any]) -> None:
    for job in workflow['jobs'].values():
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


def test_one_command_runs_everything() -> None:
    last = (ROOT / '.ci' / 'run').read_text().splitlines()[-1]
    assert last == 'exec python3 -m labkit test "$@" </dev/null'
