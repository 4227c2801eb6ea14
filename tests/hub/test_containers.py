"""The folder of a class in containers: what DockerSpawner mounts where, and who gets at what.

There is no Docker here. A namespace with the same mounts, the same user and no rights of root
stands for a container.
"""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from dockerspawner import DockerSpawner
from hub.machine import ROOT, Machine
from traitlets.config import PyFileConfigLoader

from labkit.exercises.record.class_sheet import FILE_NAME
from labkit.hub.class_list import Member
from labkit.hub.containers import MOUNTED, make_class_volumes

CLASS = (Member('anna'), Member('ben_2'), Member('maria', teaches=True))
HOME = '/home/jovyan'
JOIN = """
import labkit as lab
from labkit.exercises.record.progress_store import progress_store
from labkit.exercises.record.membership import wait_until_sent

print(lab.join_class())
progress_store.note_check('talker_listener', 'every_two_seconds', 'PASS')
lab.lesson('talker_listener')
print(wait_until_sent(60))
"""


class Containers:
    """Containers of a class on a machine.

    Args:
        machine: The machine.
        folder: The hub's folder, as `labkit hub` makes it.
    """

    def __init__(self, machine: Machine, folder: Path) -> None:
        self.machine = machine
        self.folder = folder / 'class'
        make_class_volumes(self.folder, CLASS)
        (folder / 'robots.txt').write_text('anna\nben_2\nmaria teacher\n')
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv('LABKIT_CLASS', str(folder / 'robots.txt'))
            patch.setenv('LABKIT_CLASS_FOLDER', str(self.folder))
            patch.setenv('LABKIT_HUB_TOKEN', 'secret')
            patch.setenv('LABKIT_IMAGE', 'ros-course')
            path = ROOT / 'labkit' / 'hub' / 'jupyterhub_config.py'
            self._config = PyFileConfigLoader(str(path)).load_config()

    def binds(self, member: Member) -> dict[str, dict[str, str]]:
        """Return what DockerSpawner asks Docker to mount."""
        # An admin of the hub's database teaches only if the list says so.
        user = SimpleNamespace(name=member.name, admin=True)
        spawner = DockerSpawner(user=user, config=self._config)
        for _ in range(2):  # one spawner starts a container again and again
            self._config.DockerSpawner.pre_spawn_hook(spawner)
        return dict(spawner.volume_binds)

    def run(self, member: Member, *words: str) -> subprocess.CompletedProcess[str]:
        """Run a command in somebody's container."""
        lines = ['mount -t tmpfs tmpfs /srv', f'mkdir -p {HOME}', f'mount -t tmpfs tmpfs {HOME}']
        lines.append(f'chown 1000 {HOME}')
        binds = {place: bind for place, bind in self.binds(member).items() if bind['bind'] != HOME}
        # Docker mounts what is further in later.
        for place, bind in sorted(binds.items(), key=lambda item: item[1]['bind'].count('/')):
            lines.append(f'mkdir -p {bind["bind"]}; mount --bind {place} {bind["bind"]}')
            if bind['mode'] == 'ro':
                lines.append(f'mount -o remount,bind,ro {bind["bind"]}')
        environment = {
            'HOME': HOME,
            'JUPYTERHUB_USER': member.name,
            'PYTHONPATH': str(ROOT),
            **self._config.Spawner.environment,
        }
        variables = [f'{name}={value}' for name, value in environment.items()]
        lines.append(
            'exec setpriv --reuid 1000 --regid 100 --clear-groups --bounding-set=-all '
            + shlex.join(['env', '-C', HOME, *variables, *words])
        )
        return self.machine.run('unshare', '--mount', 'sh', '-ec', '\n'.join(lines))


@pytest.fixture(scope='module')
def containers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Containers]:
    machine = Machine(tmp_path_factory.mktemp('machine'))
    # Where everybody could pass through, so that it is the hub's own folder that is closed.
    around = Path(tempfile.mkdtemp(prefix='labkit-hub-'))
    around.chmod(0o755)
    folder = around / 'hub'
    folder.mkdir(mode=0o700)
    yield Containers(machine, folder)
    machine.end()
    shutil.rmtree(around)


def test_learners_get_their_own_folder_and_teachers_the_whole(containers: Containers) -> None:
    anna, _, maria = CLASS
    own = {str(containers.folder / 'anna'): {'bind': f'{MOUNTED}/anna', 'mode': 'rw'}}
    binds = containers.binds(anna)
    assert {key: value for key, value in binds.items() if value['bind'] != HOME} == own
    assert [value['bind'] for value in binds.values()].count(HOME) == 1
    whole = {str(containers.folder): {'bind': MOUNTED, 'mode': 'ro'}}
    own = {str(containers.folder / 'maria'): {'bind': f'{MOUNTED}/maria', 'mode': 'rw'}}
    binds = containers.binds(maria)
    assert {key: value for key, value in binds.items() if value['bind'] != HOME} == whole | own


@pytest.mark.slow('a hub, with servers and kernels')
def test_a_class_in_containers_joins_and_its_teacher_sees_it(containers: Containers) -> None:
    anna, ben, maria = CLASS
    for member in (anna, ben, maria):
        joined = containers.run(member, sys.executable, '-c', JOIN)
        assert f'SHARED: your progress, as {member.name}' in joined.stdout, joined.stderr
        assert 'your teachers, and who runs the hub' in joined.stdout
        assert joined.stdout.endswith('True\n'), joined.stdout
    board = 'import labkit as lab; print(lab.classroom(names=True))'
    shown = containers.run(maria, sys.executable, '-c', board)
    assert 'Class: 3 share their progress, 3 at work, 0 stuck.' in shown.stdout, shown
    assert 'The names are those of their accounts.' in shown.stdout, shown.stdout
    assert 'every_two_seconds 3 passed' in ' '.join(shown.stdout.split()), shown.stdout
    # A learner who looks sees nobody else.
    alone = containers.run(anna, sys.executable, '-c', board)
    assert 'anna' in alone.stdout and 'ben_2' not in alone.stdout, alone


@pytest.mark.parametrize(
    ('who', 'command'),
    [
        ('anna', f'mkdir {MOUNTED}/zoe'),
        ('anna', f'cat {MOUNTED}/ben_2/{FILE_NAME}'),
        ('anna', f'mv {MOUNTED}/anna {MOUNTED}/zoe'),
        ('anna', 'ls {folder}'),
        ('anna', 'touch {folder}/anna/more'),
        ('maria', f'touch {MOUNTED}/anna/{FILE_NAME}'),
        ('maria', f'mkdir {MOUNTED}/zoe'),
        ('maria', f'rm -r {MOUNTED}/ben_2'),
    ],
)
def test_nobody_writes_what_is_anothers(who: str, command: str, containers: Containers) -> None:
    (member,) = [member for member in CLASS if member.name == who]
    assert containers.run(member, 'true').returncode == 0
    before = sorted(containers.folder.rglob('*'))
    done = containers.run(member, *command.format(folder=containers.folder).split())
    assert done.returncode != 0, done
    assert any(
        reason in done.stderr
        for reason in ('Permission denied', 'Read-only file system', 'No such file', 'busy')
    ), done.stderr
    assert sorted(containers.folder.rglob('*')) == before
