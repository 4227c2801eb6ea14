"""Many notebooks at once, each a process that takes its domain as a kernel does.

They run in a namespace of their own (`run`), where nobody else has a domain, a port or shared
memory. It is a script, so that it can be asked for any number:

    python tests/background/crowd.py talk 130
"""

from __future__ import annotations

import fcntl
import io
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))
IN_NAMESPACE = 'LABKIT_TEST_IN_NAMESPACE'
UNSHARE = ['unshare', '--net', '--mount', '--pid', '--fork', '--kill-child', '--mount-proc']
OTHER_USER = 12345
HEARD_SEC = 300.0
# Number of newcomers: memory is for those who stay.
AT_ONCE = 16


def unshare() -> list[str]:
    """Return the command prefix for a namespace, [] if this system does not allow one."""
    command = [*UNSHARE, *([] if os.geteuid() == 0 else ['--map-root-user'])]
    done = subprocess.run([*command, 'true'], capture_output=True)
    return command if done.returncode == 0 else []


def run(*words: object, env: dict[str, str]) -> Any:
    """Run a crowd in a namespace, and return its results."""
    command = [*unshare(), sys.executable, __file__, *map(str, words)]
    done = subprocess.run(command, env={**env, IN_NAMESPACE: '1'}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


class Member:
    """A process that reports its progress line by line.

    Args:
        work: What it does. It is given a function that tells a result, and one that waits until
            it is asked on.
    """

    def __init__(self, work: Callable[[Callable[[Any], object], Callable[[], object]], None]):
        ask, self._asks = os.pipe()
        self._answers, answer = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            os.close(self._asks)
            try:
                work(
                    lambda result: os.write(answer, f'{json.dumps(result)}\n'.encode()),
                    lambda: os.read(ask, 1),
                )
            except BaseException as error:
                os.write(answer, f'{json.dumps([type(error).__name__, str(error)])}\n'.encode())
            os._exit(0)
        os.close(ask)
        os.close(answer)
        self._lines = os.fdopen(self._answers)

    def next(self) -> Any:
        """Return its next result: what it tells, or the words of its error."""
        return json.loads(self._lines.readline())

    def ask(self) -> None:
        """Let it go on."""
        os.write(self._asks, b'.')

    def end(self, how: signal.Signals = signal.SIGKILL) -> None:
        """End it, and wait until it is gone."""
        os.kill(self.pid, how)
        os.waitpid(self.pid, 0)


# -- domains alone --------------------------------------------------------------------------------


def claim(user_id: int = 0) -> Member:
    """Make a process that claims a domain on request, and keeps it."""

    def work(tell: Callable[[Any], object], wait: Callable[[], object]) -> None:
        from labkit.background.domains import claim_domain

        if user_id:
            os.setuid(user_id)
        wait()
        with redirect_stdout(io.StringIO()) as said:
            held = claim_domain()
        tell([held.domain_id, said.getvalue()] if said.getvalue() else held.domain_id)
        wait()

    return Member(work)


def hog(user_id: int, address: str) -> Member:
    """Make a process that takes the ports of all claims, and keeps them.

    Args:
        user_id: Whose it is.
        address: Where it takes them; with `to` before it, it connects to them.
    """

    def work(tell: Callable[[Any], object], wait: Callable[[], object]) -> None:
        from labkit.background.domains import _KNOWN, _claim_port
        from labkit.domain_ids import BETWEEN

        os.setuid(user_id)
        word, _, place = address.rpartition(' ')
        sockets = []
        for domain_id in (*_KNOWN, *BETWEEN):
            family = socket.AF_INET6 if ':' in place else socket.AF_INET
            sockets.append(socket.socket(family, socket.SOCK_DGRAM))
            getattr(sockets[-1], 'connect' if word else 'bind')((place, _claim_port(domain_id)))
        tell('all taken')
        wait()

    return Member(work)


def greed(address: str) -> dict[str, Any]:
    """Let one account take all domains, and then notebooks of two others come."""
    from labkit.background.domains import claimed_domains

    if not _knows_users():
        return {}
    thief = hog(OTHER_USER, address)
    assert thief.next() == 'all taken'
    members = [claim(user) for user in (0, 0, 0, OTHER_USER + 1, OTHER_USER + 1, OTHER_USER)]
    found: dict[str, Any] = {'taken': at_once(members), 'own': list(claimed_domains())}
    thief.end()
    newcomer = claim()
    found['later'] = at_once([newcomer])
    return found


def at_once(members: Sequence[Member]) -> list[Any]:
    """Let all processes continue at the same time; return their next results."""
    for member in members:
        member.ask()
    return [member.next() for member in members]


def _knows_users() -> bool:
    """Tell whether the namespace has other users than the one who made it."""
    _, _, count = Path('/proc/self/uid_map').read_text(encoding='ascii').split()[:3]
    return int(count) > OTHER_USER


def claims(count: int) -> dict[str, Any]:
    """Let notebooks of two users claim domains at once, kill some, and then claim all domains."""
    from labkit.background.domains import claimed_domains

    # One name, so that each of them begins with the same domain.
    os.environ['JPY_SESSION_NAME'] = '/home/me/02_talker_listener.ipynb'
    users = (0, OTHER_USER) if _knows_users() else (0,)
    members = [claim(users[number % len(users)]) for number in range(count)]
    found: dict[str, Any] = {'claimed': at_once(members)}
    found['own'] = list(claimed_domains())
    found['of_this_user'] = found['claimed'][:: len(users)]
    for member in members[:10]:
        member.end()
    found['freed'] = found['claimed'][:10]
    members[:10] = [claim() for _ in range(10)]
    found['again'] = at_once(members[:10])
    found['rest'] = []
    while not found['rest'] or isinstance(found['rest'][-1], int):
        members.append(claim())
        found['rest'] += at_once(members[-1:])
    return found


# -- a talker and a listener in each --------------------------------------------------------------


def notebook(domain_id: int | None, name: str, period_sec: float) -> Member:
    """Make a process with a talker and a listener; it reports its domain, then its messages."""

    def work(tell: Callable[[Any], object], wait: Callable[[], object]) -> None:
        from rclpy.node import Node
        from std_msgs.msg import String

        import labkit as lab
        from labkit.background.domains import claim_domain
        from labkit.background.runtime import runtime
        from labkit.rosgraph.snapshot import node_names

        held = claim_domain() if domain_id is None else None
        number = held.domain_id if held is not None else domain_id
        lab.start(domain_id=number)
        heard: set[str] = set()

        def hear(msg: String) -> None:
            heard.add(msg.data)

        talker, listener = Node(f'talker_{name}_{number}'), Node(f'listener_{name}_{number}')
        listener.create_subscription(String, 'chatter', hear, 10)
        publisher = talker.create_publisher(String, 'chatter', 10)
        word = String(data=f'{name} of {number}')
        talker.create_timer(period_sec, lambda: publisher.publish(word))
        lab.spin(talker)
        lab.spin(listener)
        tell(number)
        wait()
        everybody = runtime.wait(lambda: len(heard) >= 2, HEARD_SEC)
        tell(everybody)
        wait()
        assert runtime.helper is not None
        names = (name for name in node_names(runtime.helper) if 'labkit' not in name)
        tell([number, sorted(heard), sorted({int(name.rpartition('_')[2]) for name in names})])
        wait()
        lab.stop()
        tell('ended')

    return Member(work)


def talk(domain_ids: list[int | None], period_sec: float) -> dict[str, Any]:
    """Let a notebook talk in each domain, and then, where all is up, a newcomer in each.

    As soon as a newcomer is known to those of its domain, so would be all others who could be.

    Args:
        domain_ids: The domains; None for one that is claimed.
        period_sec: From word to word.
    """
    import labkit.background.runtime  # noqa: F401 - so that it is loaded once for all

    started = time.monotonic()
    members = [notebook(domain_id, 'one', period_sec) for domain_id in domain_ids]
    numbers = [member.next() for member in members]
    assert all(isinstance(number, int) for number in numbers), numbers
    up = time.monotonic()
    memory = sum(_memory(member.pid) for member in members)
    reports = []
    for start in range(0, len(members), AT_ONCE):
        batch = members[start : start + AT_ONCE]
        newcomers = [notebook(number, 'other', period_sec) for number in numbers[start:][:AT_ONCE]]
        assert [member.next() for member in newcomers] == numbers[start:][:AT_ONCE]
        assert all(at_once([*batch, *newcomers])), 'some did not hear their own'
        reports += at_once(newcomers)
        assert set(at_once(newcomers)) == {'ended'}
    met = time.monotonic()
    reports += at_once(members)
    assert set(at_once(members)) == {'ended'}
    return {
        'domains': numbers,
        'reports': reports,
        'up_sec': round(up - started, 1),
        'met_sec': round(met - up, 1),
        'megabytes': round(memory / 1e6),
    }


def _memory(pid: int) -> int:
    """Return the memory of a process with its share of shared memory, in bytes."""
    with open(f'/proc/{pid}/smaps_rollup', encoding='ascii') as file:
        return sum(1024 * int(line.split()[1]) for line in file if line.startswith('Pss:'))


# -- the namespace --------------------------------------------------------------------------------


def prepare() -> None:
    """Set up loopback and shared memory in the namespace."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        up = struct.pack('16sh', b'lo', 1)  # ifreq with IFF_UP
        fcntl.ioctl(any_socket, 0x8914, up)  # SIOCSIFFLAGS
    subprocess.run(['mount', '-t', 'tmpfs', 'tmpfs', '/dev/shm'], check=True)
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'


def main(what: str, *numbers: str) -> None:
    """Run the crowd in a namespace, and print its results."""
    if not os.environ.get(IN_NAMESPACE):
        print(json.dumps(run(what, *numbers, env=dict(os.environ))))
        return
    prepare()
    found = claims(int(numbers[0])) if what == 'claims' else None
    if what == 'talk':
        found = talk([None] * int(numbers[0]), 1.0)
    if what == 'greed':
        found = greed(' '.join(numbers))
    if what == 'neighbours':
        found = talk([int(number) for number in numbers], 0.1)
    print(json.dumps(found))


if __name__ == '__main__':
    main(*sys.argv[1:])
