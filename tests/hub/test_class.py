"""Who is of a class: the list, accounts, first passwords, and what the command refuses."""

from __future__ import annotations

import dbm
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import bcrypt
import pytest

from labkit.__main__ import main
from labkit.errors import LabError, SetupError
from labkit.hub import command, proxy, start
from labkit.hub.class_list import Member, read_class
from labkit.hub.passwords import FIRST_PASSWORDS, HASHES, make_passwords
from labkit.hub.sessions import note_hub, noted_hub
from labkit.setup import environment

ROOT = Path(__file__).resolve().parents[2]


def test_list_of_a_class(tmp_path: Path) -> None:
    path = tmp_path / 'robots.txt'
    path.write_text('# Monday\nanna\n\n  ben_2   # comes later\nmaria teacher\n')
    assert read_class(path) == [Member('anna'), Member('ben_2'), Member('maria', teaches=True)]


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('', 'names nobody'),
        ('# anna\n', 'names nobody'),
        ('Anna\n', "line 1: 'Anna' can not be the name of an account"),
        ('anna\n../root\n', "line 2: '../root' can not"),
        ('-x\n', "'-x' can not"),
        ('anna;id\n', "'anna;id' can not"),
        ('a' * 21, 'up to 20 signs'),
        ('müller\n', 'can not be the name'),
        ('anna admin\n', "'admin' is not known"),
        ('anna\nben\nanna\n', "line 3: 'anna' is there twice"),
    ],
)
def test_a_list_that_can_not_be_used(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / 'robots.txt'
    path.write_text(text)
    with pytest.raises(LabError, match=words.replace('.', r'\.')):
        read_class(path)


@pytest.mark.parametrize('content', [None, b'\xff\xfe'])
def test_a_list_that_can_not_be_read(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / 'robots.txt'
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(LabError, match='can not be read'):
        read_class(path)


def passwords(folder: Path) -> dict[str, str]:
    return dict(line.split() for line in (folder / FIRST_PASSWORDS).read_text().splitlines())


def test_first_passwords_are_made_once(tmp_path: Path) -> None:
    os.umask(mask := os.umask(0o022))
    os.umask(0o077)
    try:
        assert make_passwords(tmp_path, ['anna', 'ben']) == ['anna', 'ben']
        first = passwords(tmp_path)
        assert make_passwords(tmp_path, ['anna', 'ben', 'carl']) == ['carl']
        second = passwords(tmp_path)
        assert make_passwords(tmp_path, ['anna', 'ben', 'carl'], anew=['ben']) == ['ben']
    finally:
        os.umask(mask)
    third = passwords(tmp_path)
    assert {**first, 'carl': second['carl']} == second
    assert {name for name in third if third[name] != second[name]} == {'ben'}
    assert len({*third.values(), second['ben']}) == 4
    assert all(len(password) == 14 for password in third.values())
    with dbm.open(str(tmp_path / HASHES), 'r') as hashes:
        for name, password in third.items():
            assert bcrypt.checkpw(password.encode(), hashes[name])
            assert password.encode() not in hashes[name]
    for path in tmp_path.iterdir():
        assert stat.S_IMODE(path.stat().st_mode) & 0o077 == 0, path.name


@pytest.fixture
def root(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, 'geteuid', lambda: 0)


@pytest.mark.parametrize(
    ('words', 'sentence'),
    [
        ([], 'A hub is for a class.'),
        (['--class', 'missing.txt'], 'can not be read'),
        (['--class', 'robots.txt', '--ip=0.0.0.0'], 'unencrypted'),
        (['--class', 'robots.txt', '--ip', '192.168.1.7'], 'unencrypted'),
        (['--class', 'robots.txt', '--ip='], 'unencrypted'),
        (['--class', 'robots.txt', '--JupyterHub.ip=::'], 'unencrypted'),
        (['--class', 'robots.txt', '--ip=127.0.0.1', '--ip=0.0.0.0'], 'At 0.0.0.0'),
        (['--class', 'robots.txt', '--ip=0.0.0.0', '--log-file=ssl_cert.log'], 'unencrypted'),
        (['--class', 'robots.txt', '--ip=0.0.0.0', '--ssl-cert='], 'unencrypted'),
        (['--class', 'robots.txt', '--url=http://10.0.0.7:800'], 'At 10.0.0.7'),
        (['--class', 'robots.txt', '--config=mine.py'], 'keeps learners apart'),
        (['--class', 'robots.txt', '--port=800', '--port=8000'], 'Two ports'),
        (['--class', 'robots.txt', '--port=many'], 'That is no port'),
        (['--class', 'robots.txt', '--JupyterHub.bind_url=http://:800'], 'unencrypted'),
        (['--class', 'robots.txt', '--port=8000'], 'any account of this machine could take port'),
        (['--class', 'robots.txt', '--port', '1022'], 'Choose one up to 1021'),
        (['--class', 'robots.txt', '--JupyterHub.bind_url=http://127.0.0.1:9000'], 'port 9000'),
    ],
)
def test_what_the_command_refuses(
    words: list[str],
    sentence: str,
    root: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path('robots.txt').write_text('anna\n')
    monkeypatch.setattr(command, 'make_environment', lambda files: pytest.fail('it goes on'))
    assert main(['hub', *words]) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize(
    'options',
    [
        [],
        ['--port=1021'],
        ['--image=ros-course', '--port=9000'],
        ['--ip=127.0.0.1'],
        ['--ip=0.0.0.0', '--ssl-key=k', '--ssl-cert=c'],
        ['--JupyterHub.bind_url=http://127.0.0.1:900/robots'],
    ],
)
def test_what_the_command_lets_pass(
    options: list[str], root: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'robots.txt'
    path.write_text('anna\n')
    seen: list[list[str]] = []
    monkeypatch.setattr(os, 'umask', lambda mask: 0)
    monkeypatch.setattr(command, 'make_environment', lambda files: Path(sys.executable))
    monkeypatch.setattr(command, 'install_proxy', lambda: None)
    monkeypatch.setattr(os, 'execve', lambda path, words, env: seen.append(words) or exit(0))
    with pytest.raises(SystemExit):
        main(['hub', '--class', str(path), *options])
    passed = [option for option in options if 'image' not in option]
    assert seen[0][-len(passed) - 1 :] == ['--', *passed]


def test_a_proxy_that_can_not_be_fetched_costs_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / 'share' / 'labkit-hub'
    folder.mkdir(parents=True)
    (folder / 'package-lock.json').write_text('of an older version')
    monkeypatch.setattr(proxy, '_FOLDER', folder)
    monkeypatch.setattr(proxy, '_node', lambda: tmp_path)
    failed = subprocess.CompletedProcess([], 1, stdout='npm error network')
    monkeypatch.setattr(proxy, 'run', lambda *_, **__: failed)
    with pytest.raises(SetupError):
        proxy.install_proxy()
    assert (folder / 'package-lock.json').read_text() == 'of an older version'
    assert [path for path in folder.parent.iterdir() if path.is_dir()] == [folder]


def test_two_hubs_fetch_one_proxy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / 'share' / 'labkit-hub'
    monkeypatch.setattr(environment, 'LOCKED', tmp_path / 'lock')
    monkeypatch.setattr(proxy, '_FOLDER', folder)
    monkeypatch.setattr(proxy, '_PROXY', folder / 'proxy')
    monkeypatch.setattr(proxy, '_node', lambda: tmp_path)
    second = threading.Thread(target=proxy.install_proxy)
    waits = threading.Event()
    fetched = []

    def fetch(*_: object, **__: object) -> subprocess.CompletedProcess[str]:
        fetched.append(1)
        if len(fetched) == 1:
            second.start()
            assert waits.wait(60)
        (folder / 'proxy').touch()
        return subprocess.CompletedProcess([], 0, stdout='')

    def told(*_: object, **__: object) -> None:
        if threading.current_thread() is second:
            waits.set()

    monkeypatch.setattr(proxy, 'run', fetch)
    # What waits says so.
    monkeypatch.setattr('builtins.print', told)
    proxy.install_proxy()
    second.join()
    assert len(fetched) == 1 and (folder / 'proxy').exists()


def test_where_the_hub_was_is_noted(tmp_path: Path) -> None:
    assert noted_hub(tmp_path) == ''
    note_hub(tmp_path, 'https://127.0.0.1:801')
    assert noted_hub(tmp_path) == 'https://127.0.0.1:801'


@pytest.mark.skipif(os.geteuid() != 0, reason='only root can run a program as somebody else')
def test_a_python_that_learners_can_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    python = tmp_path / 'python'
    python.write_text('#!/bin/sh\n')
    monkeypatch.setattr(sys, 'executable', str(python))
    with pytest.raises(LabError, match=r'can not use the course in .*Permission denied'):
        start._check_access('daemon')


def test_only_root_may_start_a_hub(tmp_path: Path) -> None:
    path = tmp_path / 'robots.txt'
    path.write_text('anna\n')
    code = 'import os, sys; os.geteuid = lambda: 1000; from labkit.__main__ import main; '
    code += f'sys.exit(main(["hub", "--class", {str(path)!r}]))'
    done = subprocess.run(
        [sys.executable, '-c', code], cwd=ROOT, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 2
    assert 'only root may do' in done.stderr
