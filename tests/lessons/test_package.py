"""Lesson 11: its workspace stays beside the notebook, and that of others goes with the process."""

from __future__ import annotations

import errno
import json
import shutil
import subprocess
import sys
from pathlib import Path

import built_once
import pytest

from labkit.lessons.package import learner_workspace as workspace_module
from labkit.lessons.package.learner_workspace import workspace
from labkit.lessons.package.made import BROKEN, make_broken
from labkit.lessons.your_own_machine.made import COURIER, make_courier
from labkit.packages.skeleton import Part, Skeleton

NOTEBOOKS = Path(__file__).resolve().parents[2] / 'notebooks'
WORKSPACE = """
from labkit.lessons.package.learner_workspace import make_workspace, workspace

assert workspace() is None
made = make_workspace()
assert made == make_workspace() == workspace(), 'another one'
print(made)
"""


def test_a_workspace_is_made_once_and_goes_with_the_process(script, tmp_path):
    place = tmp_path / 'temporary'
    place.mkdir()
    result = script(WORKSPACE, TMPDIR=str(place))
    assert result.exit_code == 0, result.stderr
    made = Path(result.stdout.strip())
    assert made.name == 'ros2_ws'
    assert made.is_relative_to(place) and list(place.iterdir()) == []


def test_the_workspace_of_the_learner_is_found_beside_the_notebook_and_from_inside(
    tmp_path, monkeypatch
):
    own, elsewhere = tmp_path / 'work' / 'ros2_ws', tmp_path / 'other'
    elsewhere.mkdir()
    (own / 'src' / 'ears_lab').mkdir(parents=True)
    for folder, found in [
        (own.parent, own),
        (own, own),
        (own / 'src' / 'ears_lab', own),
        (elsewhere, None),
        (tmp_path, None),
    ]:
        monkeypatch.chdir(folder)
        assert workspace() == found, folder


def test_own_programs_of_earlier_lessons_become_part_of_the_package(tmp_path, monkeypatch):
    (path,) = NOTEBOOKS.glob('11_*.ipynb')
    cells = json.loads(path.read_text('utf-8'))['cells']
    (entry,) = (''.join(cell['source']) for cell in cells if cell['id'] == 'entry')
    name = 'robot_basics_lab'
    place = tmp_path / 'ros2_ws' / 'src' / name
    for part in Skeleton(name=name, maintainer='me', email='me@example.org').parts():
        part.write(place)
    own = (place / name / 'talker.py', tmp_path / 'nodes' / 'ear.py')
    for path in own:
        path.parent.mkdir(exist_ok=True)
        path.write_text('def main(): ...')
    monkeypatch.chdir(tmp_path)
    for _ in range(2):  # a cell may be run again
        exec(entry, {})
    assert (place / name / 'ear.py').is_file()
    setup = (place / 'setup.py').read_text()
    compile(setup, 'setup.py', 'exec')
    for path in own:
        assert setup.count(f"'{path.stem} = {name}.{path.stem}:main',") == 1


def test_the_broken_package_is_made_anew_only_when_that_is_asked_for(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    setup = Path(make_broken())
    assert setup == Path('ros2_ws/src/broken_lab/setup.py')
    broken = setup.read_text()
    setup.write_text('repaired')
    assert Path(make_broken()).read_text() == 'repaired'
    assert Path(make_broken(overwrite=True)).read_text() == broken


@pytest.mark.parametrize('overwrite', [False, True])
def test_no_package_is_made_through_a_link(tmp_path, monkeypatch, overwrite):
    monkeypatch.chdir(tmp_path)
    own = tmp_path / 'repository'
    (own / BROKEN).mkdir(parents=True)
    (own / 'setup.py').write_text('years of work')
    place = tmp_path / 'ros2_ws' / 'src' / BROKEN
    place.parent.mkdir(parents=True)
    # Without being asked, what is there is left, and what leads nowhere is nothing.
    place.symlink_to(own if overwrite else 'nowhere')
    make_broken(overwrite=overwrite)
    assert sorted(path.name for path in own.iterdir()) == [BROKEN, 'setup.py']
    assert (own / 'setup.py').read_text() == 'years of work'
    assert not place.is_symlink() and (place / 'package.xml').is_file()


def test_no_courier_is_made_through_a_link(tmp_path, monkeypatch):
    monkeypatch.setattr(workspace_module, '_made', [tmp_path / 'ros2_ws'])
    own, place = tmp_path / 'repository', tmp_path / 'ros2_ws' / 'src' / COURIER
    own.mkdir()
    (own / 'package.xml').write_text('years of work')
    place.parent.mkdir(parents=True)
    place.symlink_to(own)
    assert make_courier() == place and not place.is_symlink()
    assert (own / 'package.xml').read_text() == 'years of work'
    assert [path.name for path in own.iterdir()] == ['package.xml']


@pytest.mark.parametrize('make', [lambda: make_broken(overwrite=True), make_courier])
def test_a_package_that_can_not_be_made_costs_nothing(tmp_path, monkeypatch, make):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(workspace_module, '_made', [tmp_path / 'ros2_ws'])
    (tmp_path / 'ros2_ws' / 'src').mkdir(parents=True)
    make()
    (place,) = (tmp_path / 'ros2_ws' / 'src').iterdir()
    (place / 'setup.py').write_text('repaired')

    def refuse(part, folder):
        raise OSError(errno.ENOSPC, 'No space left on device', str(folder))

    monkeypatch.setattr(Part, 'write', refuse)
    with pytest.raises(OSError, match='No space'):
        make()
    assert (place / 'setup.py').read_text() == 'repaired'


def test_what_is_recorded_has_a_workspace_that_is_always_called_the_same(script, tmp_path):
    code = (
        'from labkit.lessons.package.learner_workspace import make_workspace\n'
        'print(make_workspace())\n'
    )
    result = script(code, TMPDIR=str(tmp_path), LABKIT_HEADLESS='1')
    assert result.stdout == f'{tmp_path}/ros2_ws\n', result.stderr


MODULE = 'def main():\n    print({!r})\n'


@pytest.mark.slow('a build by colcon')
def test_a_build_that_is_kept_is_the_one_that_colcon_makes(tmp_path, monkeypatch):
    built_once.install(tmp_path / 'bin')
    work = tmp_path / 'ws'
    package = work / 'src' / 'ears_lab'
    _write_package(work / 'src' / 'first_lab')
    _write_package(package)
    monkeypatch.chdir(work)
    scripts = str(Path(sys.executable).parent)
    # What colcon runs sees its variables, and keeps them: they are to be the same each time.
    monkeypatch.setenv('PATH', f'{tmp_path / "bin"}:{scripts}:/usr/bin:/bin')
    monkeypatch.setenv('COLCON_LOG_LEVEL', 'error')

    def build(name: str, *, command: str = 'colcon') -> tuple[dict[str, bytes], str]:
        for tree in ('build', 'install'):
            shutil.rmtree(work / tree / name, ignore_errors=True)
        words = [command, 'build', '--packages-select', name]
        said = subprocess.run(words, check=True, capture_output=True, text=True).stdout
        return _files(work, name), said

    build('first_lab')
    first, said = build('ears_lab')
    kept = list((tmp_path / 'bin').glob('*/stdout'))
    assert len(kept) == 1
    # Another module: the kept one, with the module of now, and newer than its source.
    (package / 'ears_lab' / 'hear.py').write_text(MODULE.format('now'))
    taken, said_again = build('ears_lab')
    assert said_again == said and list((tmp_path / 'bin').glob('*/stdout')) == kept
    program = ['bash', '-c', '. install/setup.bash && install/ears_lab/lib/ears_lab/hear']
    assert subprocess.run(program, check=True, capture_output=True).stdout == b'now\n'
    ended = work / 'build' / 'ears_lab' / 'colcon_build.rc'
    assert ended.stat().st_mtime >= (package / 'ears_lab' / 'hear.py').stat().st_mtime
    real, _ = build('ears_lab', command=f'{scripts}/colcon')
    assert taken == real != first
    # Whatever else differs is built anew.
    setup = package / 'setup.py'
    setup.write_text(setup.read_text().replace('hear =', 'listen ='))
    changed, _ = build('ears_lab')
    assert 'install/ears_lab/lib/ears_lab/listen' in changed
    assert len(list((tmp_path / 'bin').glob('*/stdout'))) == 2


def _write_package(folder: Path) -> None:
    name = folder.name
    package = Skeleton(
        name=name,
        maintainer='me',
        email='me@example.org',
        description='Says a word',
        license='Apache-2.0',
        dependencies=['rclpy'],
        test_dependencies=[],
        scripts=[('hear', f'{name}.hear:main')],
    )
    for part in [*package.parts(), Part(f'{name}/hear.py', MODULE.format('before'))]:
        part.write(folder)


def _files(work: Path, name: str) -> dict[str, bytes]:
    """Return what was built of a package: its files and links, but what Python has compiled."""
    found = {}
    for path in [*(work / 'build' / name).rglob('*'), *(work / 'install' / name).rglob('*')]:
        if '__pycache__' not in path.parts and not path.is_dir():
            found[str(path.relative_to(work))] = path.read_bytes()
    return found
