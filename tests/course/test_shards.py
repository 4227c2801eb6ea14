"""What continuous integration runs: each test once, in a part of its own, quick checks first."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections import Counter
from collections.abc import Callable
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
    for job in workflow['jobs'].values():
        assert job['strategy']['matrix']['python'] == versions
    assert f'for version in {" ".join(versions)}; do' in (ROOT / '.ci' / 'run').read_text()


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


# Stands for a Python of a version: says so, and writes down in which folder it runs what.
PYTHON = """#!/bin/sh
case "$*" in
  -c*) echo {version} ;;
  --version) echo Python {version}.0 ;;
  *) echo "{version} $(pwd) $*" >> {log} ;;
esac
"""


@pytest.fixture
def machine(tmp_path: Path) -> Callable[..., tuple[str, list[str]]]:
    """Give a function that runs `.ci/run` on a machine with 3.11 selected, 3.10 and 3.13."""
    log = tmp_path / 'log'
    course, programs = tmp_path / 'course', tmp_path / 'bin'
    pyenv = tmp_path / 'pyenv' / 'versions' / '3.13.1' / 'bin'
    for folder in (course / '.ci', course / '.venv', programs, pyenv):
        folder.mkdir(parents=True)
    script = shutil.copy(ROOT / '.ci' / 'run', course / '.ci')
    pythons = {programs / 'python3': '3.11', programs / 'python3.10': '3.10'}
    for path, version in {**pythons, pyenv / 'python3': '3.13'}.items():
        path.write_text(PYTHON.format(version=version, log=log))
        path.chmod(0o755)
    # One of pyenv that is not selected; and nothing is to be installed here.
    looked_for = re.findall(r'command -v (\S+)', Path(script).read_text())
    for name in ('python3.12', 'python3.13', *looked_for):
        (programs / name).write_text('#!/bin/sh\nexit 127\n')
        (programs / name).chmod(0o755)

    def run(*words: str) -> tuple[str, list[str]]:
        done = subprocess.run(
            ['bash', script, *words],
            env={'PATH': f'{programs}:/usr/bin:/bin', 'PYENV_ROOT': str(tmp_path / 'pyenv')},
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout, log.read_text().splitlines()

    return run


def test_one_command_runs_everything_on_each_python(
    tmp_path: Path, machine: Callable[..., tuple[str, list[str]]]
) -> None:
    said, ran = machine()
    assert ran[0] == f'3.11 {tmp_path}/course -m labkit test'
    words = [line.split(' ', 2) for line in ran[1:]]
    assert [(version, command) for version, _, command in words] == [
        ('3.10', '-m labkit test --fast'),
        ('3.10', '-m labkit test notebooks'),
        ('3.13', '-m labkit test --fast'),
        ('3.13', '-m labkit test notebooks'),
    ]
    folders = {folder for _, folder, _ in words}
    assert f'{tmp_path}/course' not in folders
    assert not any(Path(folder).exists() for folder in folders)
    assert said.endswith(
        '.ci/run: all passed. Python: 3.11 (everything), 3.10 (quick checks, notebooks), '
        '3.12 (not here), 3.13 (quick checks, notebooks).\n'
    )


def test_a_part_runs_on_one_python(
    tmp_path: Path, machine: Callable[..., tuple[str, list[str]]]
) -> None:
    assert machine('--shard', 'ros')[1] == [f'3.11 {tmp_path}/course -m labkit test --shard ros']
