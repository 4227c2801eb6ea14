"""A real hub in other ways: with TLS, with a forgotten password, with nobody at the keyboard."""

from __future__ import annotations

import asyncio
import json
import re
import shutil
import ssl
from collections.abc import Iterator
from pathlib import Path

import bcrypt
import pytest
from hub.machine import ROOT, Hub, Machine
from hub.person import Person
from hub.test_guesses import request_from
from traitlets.config import PyFileConfigLoader

from labkit.hub.login import ClassAuthenticator
from labkit.hub.passwords import FIRST_PASSWORDS, HASHES, make_passwords

pytestmark = pytest.mark.slow('a hub, with servers and kernels')

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
        patch.setenv('LABKIT_HUB_TOKEN', 'secret')
        config = PyFileConfigLoader(str(CONFIG)).load_config()
    culler, _ = config.JupyterHub.services
    hurry = culler | {'command': [*culler['command'][:-1], '--timeout=1', '--cull-every=1']}
    assert '--timeout' in culler['command'][-1]
    return Hub(
        machine,
        folder,
        'anna\nben\n',
        f'--ssl-key={keys[0]}',
        f'--ssl-cert={keys[1]}',
        f'--JupyterHub.services={[hurry]!r}',
        f'--JupyterHub.load_roles={config.JupyterHub.load_roles[:1]!r}',
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


def test_a_password_that_one_changes(hub: Hub, trust: ssl.SSLContext) -> None:
    def change(old: str, new: str) -> str:
        fields = {'old_password': old, 'password': new, '_xsrf': anna._cookie('_xsrf')}
        return anna.ask('/hub/auth/change-password', 'POST', fields, type='form').text

    anna = Person(hub, 'anna', trust)
    first = hub.password('anna')
    anna.log_in()
    assert 'href="/hub/auth/change-password"' in anna.ask('/hub/home').text
    assert 'name="old_password"' in anna.ask('/hub/auth/change-password').text
    assert 'The old password is wrong.' in change('not it, I guess', 'a new password')
    assert 'too short' in change(first, 'short')
    assert 'too long' in change(first, 'x' * 73)
    assert 'successfully' in change(first, 'x' * 72)
    late = Person(hub, 'anna', trust)
    assert [late.log_in(word).status for word in (first, 'x' * 73, 'x' * 100)] == [403] * 3
    assert '/hub/login' not in late.log_in('x' * 72).address


def test_a_form_that_was_open_for_long_is_told_and_shown_anew(
    hub: Hub, trust: ssl.SSLContext
) -> None:
    ben = Person(hub, 'ben', trust)
    fields = {'username': 'ben', 'password': hub.password('ben'), '_xsrf': 'of an hour ago'}
    answer = ben.ask('/hub/login', 'POST', fields, type='form')
    assert answer.status == 403 and 'Login form invalid or expired. Try again.' in answer.text
    (form,) = re.findall(r'name="_xsrf"\s+value="([^"]+)"', answer.text)
    again = ben.ask('/hub/login', 'POST', fields | {'_xsrf': form}, type='form')
    assert again.status == 200 and '/hub/login' not in again.address
    # The other form of ours; JupyterHub's words for it.
    answer = ben.ask('/hub/auth/change-password', 'POST', fields, type='form')
    assert answer.status == 403 and 'XSRF cookie does not match' in answer.text
    assert 'Traceback' not in hub.log


def test_names_are_not_told_by_the_time_it_takes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A comparison for each name, and the hub goes on meanwhile."""
    compared: list[bytes] = []

    async def log_in(name: str, password: str) -> str | None:
        data = {'username': name, 'password': password}
        return await keeper.authenticate(request_from('192.0.2.7'), data)

    async def try_all() -> list[str | None]:
        for name in ('anna', 'nobody', 'zoe'):
            await keeper.authenticate(
                request_from('192.0.2.7'), {'username': name, 'password': 'x' * 100}
            )
        ticks = 0
        make_passwords(tmp_path, ['carl'])
        password = first_password(tmp_path, 'carl')
        attempts = [
            asyncio.ensure_future(
                keeper.authenticate(
                    request_from('192.0.2.7'), {'username': 'carl', 'password': word}
                )
            )
            for word in ('wrong', 'wrong', password)
        ]
        while not all(attempt.done() for attempt in attempts):
            ticks += 1
            await asyncio.sleep(0)
        assert ticks > 10
        return [attempt.result() for attempt in attempts]

    def compare(password: bytes, stored: bytes) -> bool:
        compared.append(stored)
        return checkpw(password, stored)

    checkpw = bcrypt.checkpw
    monkeypatch.setattr(bcrypt, 'checkpw', compare)
    make_passwords(tmp_path, ['anna'])
    keeper = ClassAuthenticator(dbm_path=str(tmp_path / HASHES), check_passwords_on_startup=False)
    assert asyncio.run(try_all()) == [None, None, 'carl']
    assert len(compared) == 6


def first_password(folder: Path, name: str) -> str:
    lines = (folder / FIRST_PASSWORDS).read_text().splitlines()
    return dict(line.split() for line in lines)[name]


@pytest.mark.parametrize('name', ['root', 'daemon', 'teacher'])
def test_an_account_that_was_there_is_nobodys(name: str, hub: Hub, tmp_path: Path) -> None:
    hub.machine.run('useradd', 'teacher')
    path = tmp_path / 'robots.txt'
    path.write_text(f'zoe\n{name}\n')
    code, said = hub.command(f'--class={path}')
    assert code == 2
    assert f'{name!r} is an account of this machine that was not made for a class.' in said
    assert hub.machine.run('id', 'zoe').returncode != 0  # nothing half done
    assert 'zoe' not in (hub.state / 'first-passwords.txt').read_text()
