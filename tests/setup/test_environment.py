"""Making the environment on real machines: what goes wrong, and what is left then."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import signal
import subprocess
import sys
import venv
from collections.abc import Iterator
from pathlib import Path

import pytest
from courses import (
    BARE_PATH,
    ROOT,
    TIMEOUT_SEC,
    Course,
    Gate,
    base_python,
    sentence,
    wait_for_line,
)

from labkit.course.run_tests import REQUIREMENTS
from labkit.errors import SetupError
from labkit.setup import machine
from labkit.setup.requirements import applicable


@pytest.fixture
def gate(course: Course) -> Iterator[Gate]:
    gate = Gate(course.folder)
    yield gate
    gate.close()


def test_made_once_then_completed_then_updated(course: Course) -> None:
    first = course.make()
    assert first.returncode == 0, first.stderr
    assert 'Installed    1 of 1 packages' in first.stdout
    assert course.installed() == {'alpha-1.0'}
    again = course.make()
    assert (again.returncode, again.stdout) == (0, '')

    # What the tests need comes on top.
    requirements = course.folder / 'tests' / 'requirements.txt'
    requirements.write_text(course.wheel('checker'))
    files = "('environment.txt', 'tests/requirements.txt')"
    with_tests = course.python(f'labkit.setup.environment.make_environment({files})')
    assert 'tests/requirements.txt was not installed' in with_tests.stdout
    assert course.installed() == {'alpha-1.0', 'checker-1.0'}

    # A learner's environment is not behind because of them, and neither gets lost.
    course.require(course.wheel('alpha', '2.0'), course.wheel('beta'))
    assert 'environment.txt has changed' in course.make().stdout
    assert course.installed() == {'alpha-2.0', 'beta-1.0', 'checker-1.0'}
    assert course.python(f'labkit.setup.environment.make_environment({files})').stdout == ''


@pytest.mark.slow('it makes environments')
def test_failed_install_leaves_nothing(course: Course) -> None:
    course.require('./missing-1.0-py3-none-any.whl')
    assert 'missing-1.0' in sentence(course.make())
    assert not course.venv.exists()


@pytest.mark.slow('it makes environments')
def test_failed_update_leaves_what_was_there(course: Course) -> None:
    assert course.make().returncode == 0
    before = (course.venv / 'labkit.json').read_text()
    course.require('http://127.0.0.1:9/beta-1.0-py3-none-any.whl')
    assert 'network' in sentence(course.make())
    assert (course.venv / 'labkit.json').read_text() == before
    assert course.installed() == {'alpha-1.0'}


@pytest.mark.slow('it makes environments')
def test_killed_half_way_then_repeated(course: Course, gate: Gate) -> None:
    course.require(course.wheel('alpha'), f'{gate.url}/slow-1.0-py3-none-any.whl')
    course.wheel('slow')
    killed = course.start(course.script('labkit.setup.environment.make_environment()'))
    assert gate.asked.wait(TIMEOUT_SEC)
    os.kill(killed.pid, signal.SIGKILL)
    killed.wait(TIMEOUT_SEC)
    # The installer lives on and keeps the lock, so the second one does not get in its way.
    second = course.start(course.script('labkit.setup.environment.make_environment()'))
    wait_for_line(second, 'Another labkit is setting up')
    gate.opened.set()
    output = second.communicate(timeout=TIMEOUT_SEC)[0]
    assert second.returncode == 0, output
    assert 'making it was interrupted' in output
    assert course.installed() == {'alpha-1.0', 'slow-1.0'}


@pytest.mark.slow('makes environments')
def test_interrupt_key_leaves_nothing(course: Course, gate: Gate) -> None:
    course.require(f'{gate.url}/slow-1.0-py3-none-any.whl')
    course.wheel('slow')
    process = course.start(course.script('labkit.setup.environment.make_environment()'))
    assert gate.asked.wait(TIMEOUT_SEC)
    os.killpg(process.pid, signal.SIGINT)
    output = process.communicate(timeout=TIMEOUT_SEC)[0]
    assert process.returncode == 130
    assert 'interrupted' in output
    assert 'Traceback' not in output.split('labkit: ')[-1]
    assert not course.venv.exists()


@pytest.mark.slow('makes environments')
def test_two_at_once(course: Course, gate: Gate) -> None:
    course.require(f'{gate.url}/slow-1.0-py3-none-any.whl')
    course.wheel('slow')
    first = course.start(course.script('labkit.setup.environment.make_environment()'))
    assert gate.asked.wait(TIMEOUT_SEC)
    second = course.start(course.script('labkit.setup.environment.make_environment()'))
    wait_for_line(second, 'Another labkit is setting up')
    gate.opened.set()
    assert 'Making the environment' in first.communicate(timeout=TIMEOUT_SEC)[0]
    assert second.communicate(timeout=TIMEOUT_SEC)[0] == ''
    assert (first.returncode, second.returncode) == (0, 0)
    assert course.installed() == {'slow-1.0'}


def test_nobody_else_can_hold_it_up(course: Course) -> None:
    course.require('./missing-1.0-py3-none-any.whl')
    # Whoever can read the course's folder can lock that, as a learner on a hub can.
    folder = os.open(course.folder, os.O_RDONLY)
    fcntl.flock(folder, fcntl.LOCK_EX)
    try:
        assert 'missing-1.0' in sentence(course.make())
    finally:
        os.close(folder)
    assert (course.folder / '.venv.lock').stat().st_mode & 0o777 == 0o600


@pytest.mark.slow('it makes environments')
@pytest.mark.parametrize(
    ('damage', 'reason'),
    [
        ('gone', 'its Python is gone'),
        ('stamp', 'making it was interrupted'),
        ('moved', 'its folder was moved'),
        ('other', 'its Python was replaced'),
    ],
)
def test_broken_environment_is_made_anew(course: Course, damage: str, reason: str) -> None:
    assert course.make().returncode == 0
    python = course.venv / 'bin' / 'python'
    if damage == 'gone':
        # The Python that it was made with is not installed any more.
        for link in (course.venv / 'bin').glob('python*'):
            link.unlink()
            link.symlink_to('/nowhere/python3')
    elif damage == 'stamp':
        (course.venv / 'labkit.json').write_text('{"installed": 5')
    elif damage == 'moved':
        course.folder = course.folder.rename(course.folder.with_name('elsewhere'))
        course.venv = course.folder / '.venv'
    else:
        # The system's `python3` has become another version: there is no folder for it.
        python.unlink()
        shutil.copy('/bin/true', python)
    done = course.make()
    assert done.returncode == 0, done.stderr
    assert f'Making the environment {course.venv} ({reason})' in done.stdout
    assert course.installed() == {'alpha-1.0'}


def held(folder: Path) -> dict[Path, bytes | str]:
    """Return all that a folder holds: files with their content, links with where they lead."""
    links = {path: os.readlink(path) for path in folder.rglob('*') if path.is_symlink()}
    files = [path for path in folder.rglob('*') if path.is_file() and path not in links]
    return {**links, **{path: path.read_bytes() for path in files}}


def as_if_made(folder: Path, owner: Path) -> None:
    """Write what tells an environment from another folder, and a file that can be lost."""
    (folder / 'bin').mkdir(parents=True)
    (folder / 'bin' / 'python').symlink_to(sys.executable)
    (folder / 'pyvenv.cfg').write_text('')
    (folder / 'precious').write_text('kept')
    (folder / 'labkit.json').write_text(json.dumps({'installed': {}, 'folder': str(owner)}))


@pytest.mark.parametrize(
    ('content', 'why'),
    [
        ('other', 'is the environment of'),
        ('unstamped', 'is no environment that this course has made'),
        ('unfinished', 'making it was interrupted'),
        ('none', 'is not a Python environment'),
        ('gone', 'is not there'),
    ],
)
def test_nothing_behind_a_link_is_changed(course: Course, content: str, why: str) -> None:
    behind = course.folder.with_name('elsewhere') / '.venv'
    if content in ('other', 'unstamped', 'unfinished'):
        as_if_made(behind, behind)
    if content == 'unstamped':
        (behind / 'labkit.json').unlink()
    elif content == 'unfinished':
        (behind / 'labkit.json').write_text('{}')
    elif content == 'none':
        behind.mkdir(parents=True)
        (behind / 'thesis.txt').write_text('years of work')
    course.venv.symlink_to(behind)
    before = held(behind.parent)
    said = sentence(course.make())
    assert why in said and 'venv`' not in said.replace(f'`rm {course.venv}`', '')
    assert held(behind.parent) == before
    assert os.readlink(course.venv) == str(behind)


@pytest.mark.slow('it makes environments')
def test_an_empty_folder_behind_a_link_is_filled_and_used(course: Course) -> None:
    behind = course.folder.with_name('big_disk')
    behind.mkdir()
    course.venv.symlink_to(behind)
    course.require('./missing-1.0-py3-none-any.whl')
    assert 'missing-1.0' in sentence(course.make())
    assert course.venv.is_symlink() and held(behind) == {}
    course.require(course.wheel('alpha'))
    assert 'Making the environment' in course.make().stdout
    assert (behind / 'labkit.json').exists()
    assert course.make().stdout == ''
    course.require(course.wheel('alpha'), course.wheel('beta'))
    assert 'Updating the environment' in course.make().stdout
    assert course.installed() == {'alpha-1.0', 'beta-1.0'}


def test_an_environment_that_can_not_be_replaced_is_kept(course: Course) -> None:
    as_if_made(course.venv, course.folder / 'before' / '.venv')
    before = held(course.venv)
    # There is no such package, so no new environment can be made.
    course.require('./missing-1.0-py3-none-any.whl')
    done = course.make()
    assert 'Making the environment' in done.stdout and 'missing-1.0' in sentence(done)
    assert held(course.venv) == before
    assert not course.folder.joinpath('.venv.old').exists()


def test_a_link_where_the_old_one_waits_goes_alone(course: Course) -> None:
    as_if_made(course.venv, course.folder / 'before' / '.venv')
    behind = course.folder.with_name('elsewhere')
    behind.mkdir()
    (behind / 'thesis.txt').write_text('years of work')
    course.folder.joinpath('.venv.old').symlink_to(behind)
    course.require('./missing-1.0-py3-none-any.whl')
    assert 'missing-1.0' in sentence(course.make())
    assert (behind / 'thesis.txt').read_text() == 'years of work'


def test_a_full_disk_does_not_cost_the_environment(course: Course) -> None:
    as_if_made(course.venv, course.folder / 'before' / '.venv')
    # Afterwards, on that disk, what is left is printed.
    look = 'set +e; (cd "$0"; "$@"); code=$?; cat "$0/.venv/precious"; exit $code'
    done = in_namespace(course, f'{on_disk_of(40, course)}; {look}')
    said = sentence(done)
    assert 'needs 1.2 GB of disk space' in said and 'delete the old environment' in said
    assert done.stdout.endswith('kept')


@pytest.mark.slow('it makes environments')
def test_patch_release_of_python_changes_nothing(course: Course) -> None:
    assert course.make().returncode == 0
    stamp = course.venv / 'labkit.json'
    old = json.loads(stamp.read_text())
    stamp.write_text(json.dumps({**old, 'interpreter': ['/usr/bin/python3', 1, 1]}))
    course.require('http://127.0.0.1:9/nothing-1.0-py3-none-any.whl')  # it must not install
    stamp.write_text(stamp.read_text().replace(*_digests(course, old)))
    done = course.make()
    assert (done.returncode, done.stdout) == (0, '')
    assert json.loads(stamp.read_text())['interpreter'] == old['interpreter']


def _digests(course: Course, stamp: dict[str, dict[str, str]]) -> tuple[str, str]:
    import hashlib

    new = hashlib.sha256((course.folder / 'environment.txt').read_bytes()).hexdigest()
    return stamp['installed']['environment.txt'], new


@pytest.fixture(scope='module', params=['uv', 'pip'])
def installed(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Course:
    """Give a course whose environment is up to date and has labkit itself."""
    # Built without a network, once for the tests that change it: each leaves it up to date.
    course = Course(tmp_path_factory.mktemp(request.param) / 'course')
    if request.param == 'pip':
        course.env['PATH'] = BARE_PATH
    course.env.update(UV_NO_BUILD_ISOLATION='1', PIP_NO_BUILD_ISOLATION='0')
    for name in ('pyproject.toml', 'LICENSE'):
        shutil.copy(ROOT / name, course.folder)
    done = course.make()
    assert done.returncode == 0, done.stderr
    course.lend_packages()
    course.require('-e .')
    done = course.make()
    assert done.returncode == 0, done.stderr
    assert (course.venv / 'bin' / 'labkit').is_file()
    return course


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.slow('it makes environments')
def test_new_command_of_the_same_version_arrives(installed: Course) -> None:
    commands = "ros2 = 'labkit.ros2:main'"
    change(installed.folder / 'pyproject.toml', commands, f"{commands}\nros3 = 'labkit:main'")
    done = installed.make()
    assert (done.returncode, 'labkit has changed' in done.stdout) == (0, True), done.stderr
    assert (installed.venv / 'bin' / 'ros3').is_file()
    assert installed.make().stdout == ''


@pytest.mark.slow('it makes environments')
def test_new_defaults_of_jupyterlab_of_the_same_version_arrive(installed: Course) -> None:
    name = 'etc/jupyter/labconfig/default_setting_overrides.json'
    (installed.folder / 'labkit' / 'data' / name).write_text('{"new": true}')
    done = installed.make()
    assert (done.returncode, 'labkit has changed' in done.stdout) == (0, True), done.stderr
    assert (installed.venv / name).read_text() == '{"new": true}'
    assert installed.make().stdout == ''


@pytest.mark.slow('it makes environments')
def test_new_settings_of_a_tool_install_nothing(course: Course) -> None:
    shutil.copy(ROOT / 'pyproject.toml', course.folder)
    assert course.make().returncode == 0
    change(course.folder / 'pyproject.toml', 'line-length = 99', 'line-length = 100')
    assert course.make().stdout == ''
    change(course.folder / 'labkit' / '__init__.py', "__version__ = '", "__version__ = '9")
    assert 'labkit has changed' in course.make().stdout


@pytest.mark.slow('makes environments')
def test_environment_made_by_hand_is_completed_not_replaced(course: Course) -> None:
    venv.create(course.venv)
    (course.venv / 'mine').write_text('kept')
    done = course.make()
    assert done.returncode == 0, done.stderr
    assert 'it is incomplete' in done.stdout
    assert (course.venv / 'mine').read_text() == 'kept'
    assert course.installed() == {'alpha-1.0'}


def test_folder_that_is_no_environment_is_left_alone(course: Course) -> None:
    course.venv.mkdir()
    (course.venv / 'thesis.txt').write_text('years of work')
    assert 'is not a Python environment' in sentence(course.make())
    assert (course.venv / 'thesis.txt').read_text() == 'years of work'


@pytest.mark.parametrize(
    'version', ['3.14.0', pytest.param('3.9.18', marks=pytest.mark.slow('it makes environments'))]
)
def test_wrong_python_is_named(course: Course, version: str) -> None:
    code = (
        f'(setattr(sys, "version_info", ({version.replace(".", ", ")}, "final", 0)), '
        f'setattr(__import__("platform"), "python_version", lambda: {version!r}), '
        'labkit.setup.environment.make_environment())'
    )
    done = course.python(code, PATH='/nowhere')
    assert f'3.10, 3.11, 3.12 or 3.13 (CPython, 64 bits), but this is Python {version}' in (
        sentence(done)
    )
    assert not course.venv.exists()
    # Where another one is on PATH, that one is used, and it is said which.
    fitting = course.folder / 'bin' / 'python{}.{}'.format(*machine.find_interpreter().version)
    fitting.parent.mkdir()
    fitting.symlink_to(base_python())
    done = course.python(code, PATH=f'{fitting.parent}:{course.folder / "uv"}')
    assert done.returncode == 0, done.stderr
    assert f'with {fitting}, Python' in done.stdout


@pytest.mark.slow('makes environments')
def test_python_without_ensurepip(course: Course) -> None:
    code = '(sys.modules.update(ensurepip=None), labkit.setup.environment.make_environment())'
    assert 'sudo apt install python3.' in sentence(course.python(code, PATH=BARE_PATH))
    assert not course.venv.exists()
    # uv does not need it.
    assert course.python(code).returncode == 0


@pytest.mark.parametrize(
    ('system', 'processor', 'libc'),
    [
        ('Darwin', 'arm64', 'no glibc'),
        ('Windows', 'AMD64', 'no glibc'),
        ('Linux', 'aarch64', 'glibc 2.36'),
        ('Linux', 'x86_64', 'no glibc'),
        ('Linux', 'x86_64', 'glibc 2.27'),
    ],
)
def test_other_platforms_are_told_what_to_do(system: str, processor: str, libc: str) -> None:
    with pytest.raises(SetupError, match='robostack-jazzy'):
        machine.check_platform(system, processor, libc)
    machine.check_platform('Linux', 'x86_64', 'glibc 2.28')


@pytest.mark.slow('it makes environments')
def test_no_network(course: Course) -> None:
    course.require('http://127.0.0.1:9/alpha-1.0-py3-none-any.whl')
    assert 'Connect to the internet' in sentence(course.make())
    assert not course.venv.exists()


def in_namespace(course: Course, mount: str, path: str = '') -> subprocess.CompletedProcess[str]:
    """Make the environment where a file system was mounted for this command alone."""
    unshare = ['unshare', '--mount', *([] if os.geteuid() == 0 else ['--map-root-user'])]
    if subprocess.run([*unshare, 'true'], capture_output=True).returncode != 0:
        pytest.skip('this system does not allow mount namespaces')
    command = [*unshare, 'sh', '-ec', f'{mount}; cd "$0"; exec "$@"', str(course.folder)]
    return subprocess.run(
        [*command, *course.script('labkit.setup.environment.make_environment()')],
        env={**course.env, 'PATH': path or course.env['PATH']},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_SEC,
        stdin=subprocess.DEVNULL,
    )


def on_disk_of(megabytes: int, course: Course) -> str:
    """Return the shell commands that put the course on a disk of its own."""
    copy = course.folder.with_name('copy')
    course.folder.rename(copy)
    course.folder.mkdir()
    # What the course's `uv` links to is elsewhere.
    return f'mount -t tmpfs -o size={megabytes}m none "$0"; cp -r {copy}/. "$0"'


def test_read_only_disk(course: Course) -> None:
    done = in_namespace(course, 'mount --bind "$0" "$0"; mount -o remount,ro,bind "$0"')
    assert 'can not be written to' in sentence(done)
    assert not course.venv.exists()


def test_small_disk(course: Course) -> None:
    done = in_namespace(course, on_disk_of(40, course))
    assert 'needs 1.2 GB of disk space, but only 0.0 GB are free' in sentence(done)


@pytest.mark.slow('it makes environments')
@pytest.mark.parametrize('path', ['', BARE_PATH], ids=['uv', 'pip'])
def test_disk_that_gets_full(course: Course, path: str) -> None:
    big = Path(course.folder, course.wheel('big', size=60_000_000))
    course.require(str(big.rename(course.folder.with_name(big.name))))
    # There was space when it was asked for, as it were.
    module = course.folder / 'labkit' / 'setup' / 'environment.py'
    module.write_text(module.read_text().replace('1_200_000_000', '1_000'))
    done = in_namespace(course, on_disk_of(50, course), path)
    assert 'There is no disk space left' in sentence(done)


@pytest.fixture
def proxy(course: Course) -> Iterator[Gate]:
    """Give a server whose certificate is of its own making, in a place where nothing knows it."""
    if not shutil.which('openssl'):
        pytest.skip('the command openssl is missing')
    certificate = course.folder / 'proxy.pem'
    make = ['openssl', 'req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-subj', '/CN=proxy']
    make += ['-addext', 'subjectAltName=IP:127.0.0.1', '-addext', 'basicConstraints=CA:FALSE']
    subprocess.run(
        [*make, '-keyout', str(certificate), '-out', f'{certificate}.crt'],
        check=True,
        capture_output=True,
    )
    with certificate.open('a') as file:
        file.write(Path(f'{certificate}.crt').read_text())
    for name in ('SSL_CERT_FILE', 'SSL_CERT_DIR', 'PIP_CERT', *_BUNDLES):
        course.env.pop(name, None)
    course.env['PIP_CONFIG_FILE'] = os.devnull
    gate = Gate(course.folder, certificate)
    gate.opened.set()
    course.require(f'{gate.url}/alpha-1.0-py3-none-any.whl')
    yield gate
    gate.close()


_BUNDLES = ('REQUESTS_CA_BUNDLE', 'CURL_CA_BUNDLE')
# Where Debian's OpenSSL, and most programs anywhere, look for what the system trusts.
_TRUST = """mount -t tmpfs none /etc/ssl; mkdir /etc/ssl/certs
for at in ca-certificates.crt $(openssl x509 -hash -noout -in "$0"/proxy.pem.crt).0; do
  cp "$0"/proxy.pem.crt /etc/ssl/certs/$at
done"""


@pytest.mark.slow('it makes environments')
@pytest.mark.parametrize('path', ['', BARE_PATH], ids=['uv', 'pip'])
@pytest.mark.usefixtures('proxy')
def test_what_the_system_trusts_is_trusted(course: Course, path: str) -> None:
    done = in_namespace(course, _TRUST, path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert 'Trying pip' not in done.stdout
    assert course.installed() == {'alpha-1.0'}


@pytest.mark.slow('it makes environments')
@pytest.mark.parametrize('path', ['', BARE_PATH], ids=['uv', 'pip'])
@pytest.mark.usefixtures('proxy')
def test_a_certificate_that_is_not_trusted_is_named(course: Course, path: str) -> None:
    course.env['PATH'] = path or course.env['PATH']
    done = course.make()
    said = sentence(done)
    assert 'a certificate that is not trusted here' in said and 'SSL_CERT_FILE' in said
    assert ('invalid peer certificate: UnknownIssuer' in done.stdout) == (not path)
    # What the sentence says does help.
    helped = course.make(SSL_CERT_FILE=f'{course.folder}/proxy.pem.crt')
    assert (helped.returncode, 'Trying pip' in helped.stdout) == (0, False), helped.stderr


def test_markers_of_requirements() -> None:
    lines = [
        '# a remark',
        'one==1  # why',
        "two==1 ; python_full_version < '3.11'",
        "two==2 ; python_full_version >= '3.11'",
        "three==1 ; python_full_version == '3.11.*'",
        "four==1 ; python_full_version >= '3.11.5'  # why",
    ]
    assert len(applicable(lines, (3, 10, 2))) == 2
    assert len(applicable(lines, (3, 11, 4))) == 3
    assert len(applicable(lines, (3, 11, 7))) == 4
    assert len(applicable(lines, (3, 12, 0))) == 3


def test_other_ros_installations_are_kept_out(monkeypatch: pytest.MonkeyPatch) -> None:
    wheels = '/other/.venv/lib/python3.11/site-packages/ros_rcl.libs'
    monkeypatch.setenv('_ROS_WHEELS_BOOTSTRAP_COMPLETE', '1')
    monkeypatch.setenv('AMENT_PREFIX_PATH', '/home/me/ws/install/mine:/opt/ros/humble')
    monkeypatch.setenv('LD_LIBRARY_PATH', f'/opt/ros/humble/lib:/mine:/other/.venv/lib:{wheels}')
    monkeypatch.setenv('PYTHONPATH', '/home/me/ws/install/mine/lib/python3.10/site-packages')
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_cyclonedds_cpp')
    monkeypatch.setenv('ROS_DISTRO', 'humble')
    monkeypatch.setenv('ROS_VERSION', '2')
    clean = machine.clean_environment()
    assert clean['LD_LIBRARY_PATH'] == '/mine' and clean['ROS_VERSION'] == '2'
    gone = {'_ROS_WHEELS_BOOTSTRAP_COMPLETE', 'AMENT_PREFIX_PATH', 'PYTHONPATH', 'ROS_DISTRO'}
    assert not {*gone, 'RMW_IMPLEMENTATION'} & set(clean)


def test_every_requirement_is_pinned() -> None:
    for name in REQUIREMENTS:
        lines = applicable((ROOT / name).read_text().splitlines(), (3, 12, 0))
        loose = [line for line in lines if '==' not in line and line != '-e .']
        assert not loose, f'{name}: {loose}'
        names = [line.partition('==')[0].lower() for line in lines]
        assert len(names) == len(set(names)), f'{name} has a package twice'
