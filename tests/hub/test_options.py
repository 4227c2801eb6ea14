"""A real hub in other ways: with TLS, with a forgotten password, with nobody at the keyboard."""

from __future__ import annotations

import json
import shutil
import ssl
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hub.machine import ROOT, Hub, Machine
from hub.person import Person
from traitlets.config import PyFileConfigLoader

CONFIG = ROOT / 'labkit' / 'hub' / 'jupyterhub_config.py'


@pytest.fixture(scope='module')
def machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    made = Machine(tmp_path_factory.mktemp('machine'))
    yield made
    made.end()


@pytest.fixture(scope='module')
def keys(machine: Machine, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Make a key and a certificate, with the command that docs/hub.md has."""
    if shutil.which('openssl') is None:
        pytest.skip('the command openssl is missing')
    folder = tmp_path_factory.mktemp('keys')
    lines = (ROOT / 'docs' / 'hub.md').read_text().replace('\\\n', ' ').splitlines()
    (command,) = [line for line in lines if line.startswith('openssl req')]
    words = command.replace('192.168.1.7', '127.0.0.1').split()
    done = machine.run('env', '-C', str(folder), *words)
    assert done.returncode == 0, done.stderr
    return folder / 'hub.key', folder / 'hub.crt'


@pytest.fixture(scope='module')
def hub(
    machine: Machine, keys: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory
) -> Hub:
    folder = tmp_path_factory.mktemp('hub')
    # The culler of the configuration, in a hurry.
    (folder / 'robots.txt').write_text('anna\nben\n')
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv('LABKIT_CLASS', str(folder / 'robots.txt'))
        patch.setenv('LABKIT_CLASS_FOLDER', str(folder / 'class'))
        config = PyFileConfigLoader(str(CONFIG)).load_config()
    (culler,) = config.JupyterHub.services
    hurry = culler | {'command': [*culler['command'][:-1], '--timeout=1', '--cull-every=1']}
    assert '--timeout' in culler['command'][-1]
    return Hub(
        machine,
        folder,
        'anna\nben\n',
        f'--ssl-key={keys[0]}',
        f'--ssl-cert={keys[1]}',
        f'--JupyterHub.services={[hurry]!r}',
    )


@pytest.fixture
def trust(keys: tuple[Path, Path]) -> ssl.SSLContext:
    return ssl.create_default_context(cafile=str(keys[1]))


def test_with_tls_there_is_no_other_way_in(hub: Hub, trust: ssl.SSLContext) -> None:
    answer = Person(hub, 'anna', trust).ask('/')
    assert answer.status == 200 and answer.address.startswith('https://')
    with pytest.raises(OSError):
        Person(hub, 'anna').ask('/')
    with pytest.raises(OSError, match='CERTIFICATE_VERIFY_FAILED'):
        Person(hub, 'anna', ssl.create_default_context()).ask('/')


def test_what_nobody_uses_is_ended_and_files_stay(
    hub: Hub, machine: Machine, trust: ssl.SSLContext
) -> None:
    anna = Person(hub, 'anna', trust)
    anna.log_in()  # which starts the server
    anna.get_token()

    def servers() -> object:
        return json.loads(anna.ask('/hub/api/users/anna').text)['servers']

    hub.wait(lambda: 'Culling server anna' in hub.log, 'the culler')
    hub.wait(lambda: not servers(), "the end of anna's server")
    assert machine.run('pgrep', '-u', 'anna').stdout == ''
    assert machine.run('ls', '/home/anna/work/00_start_here.ipynb').returncode == 0


def labkit(hub: Hub, *words: str) -> tuple[int, str]:
    command = ['env', '-C', str(ROOT), sys.executable, '-m', 'labkit', 'hub']
    done = hub.machine.run(*command, f'--folder={hub.state}', *words)
    return done.returncode, done.stdout + done.stderr


def test_a_forgotten_password(hub: Hub, trust: ssl.SSLContext) -> None:
    old = hub.password('ben')
    code, said = labkit(hub, f'--class={hub.list}', '--new-password=ben')
    assert code == 0 and str(hub.state) in said, said
    assert hub.password('ben') != old and old not in said and hub.password('ben') not in said
    ben = Person(hub, 'ben', trust)
    assert ben.log_in(old).status == 403
    assert '/hub/login' not in ben.log_in().address
    code, said = labkit(hub, f'--class={hub.list}', '--new-password=zoe')
    assert (code, said) == (2, "labkit: 'zoe' is not in robots.txt.\n")


@pytest.mark.parametrize('name', ['root', 'daemon', 'teacher'])
def test_an_account_that_was_there_is_nobodys(name: str, hub: Hub, tmp_path: Path) -> None:
    hub.machine.run('useradd', 'teacher')
    path = tmp_path / 'robots.txt'
    path.write_text(f'zoe\n{name}\n')
    code, said = labkit(hub, f'--class={path}')
    assert code == 2
    assert f'{name!r} is an account of this machine that was not made for a class.' in said
    assert hub.machine.run('id', 'zoe').returncode != 0  # nothing half done
    assert 'zoe' not in (hub.state / 'first-passwords.txt').read_text()
