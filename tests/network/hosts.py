"""Hosts of a network of their own: each a network namespace, plugged into one switch."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest

SWITCH = 'switch'


def ip(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(['ip', *words], capture_output=True, text=True)


def do(*words: str) -> None:
    done = ip(*words)
    assert done.returncode == 0, done.stderr


class Network:
    """Hosts 1, 2, 3, ... with the addresses 10.77.0.1, 10.77.0.2, ...

    Args:
        env: Variables of the processes that are started on them.
    """

    def __init__(self, env: dict[str, str]) -> None:
        self.env = env
        self._name = f'labkit-{os.getpid()}'
        self._hosts: list[str] = []
        self._processes: list[subprocess.Popen[str]] = []

    def build(self, count: int) -> None:
        """Make the switch, in a namespace of its own, and so many hosts."""
        self._add(f'{self._name}-0')
        do('-n', self._hosts[0], 'link', 'add', SWITCH, 'type', 'bridge', 'mcast_snooping', '0')
        do('-n', self._hosts[0], 'link', 'set', SWITCH, 'up')
        for number in range(1, count + 1):
            self._plug_in(number)
        for host in self._hosts[1:]:
            _wait_for_cable(host)

    def start(self, host: int, *command: str, **env: str) -> subprocess.Popen[str]:
        """Start a command on a host. It ends with the test."""
        self._processes.append(
            subprocess.Popen(
                ['ip', 'netns', 'exec', self._hosts[host], *command],
                env={**self.env, **env},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        )
        return self._processes[-1]

    def python(self, host: int, code: str, **env: str) -> subprocess.Popen[str]:
        """Start a script on a host."""
        return self.start(host, sys.executable, '-c', code, **env)

    def without_multicast(self) -> None:
        """Let the switch drop what goes to many, as that of many a school does."""
        for number in range(1, len(self._hosts)):
            port = f'port{number}'
            # Addresses of computers are still found: those questions are broadcasts.
            switch = ('-n', self._hosts[0], 'link', 'set', port, 'type', 'bridge_slave')
            do(*switch, 'mcast_flood', 'off')
            do(*switch, 'bcast_flood', 'on')

    def end(self) -> None:
        """End all that was started, and take the network away."""
        for process in self._processes:
            if process.poll() is None:
                process.kill()
            process.communicate()
        for host in self._hosts:
            ip('netns', 'del', host)

    def _add(self, host: str) -> None:
        refused = ip('netns', 'add', host).stderr
        if refused:
            pytest.skip(f'network namespaces are not allowed here: {refused.strip()}')
        self._hosts.append(host)

    def _plug_in(self, number: int) -> None:
        switch, host = self._hosts[0], f'{self._name}-{number}'
        self._add(host)
        port = f'port{number}'
        do('-n', host, 'link', 'add', 'cable', 'type', 'veth', 'peer', port, 'netns', switch)
        do('-n', switch, 'link', 'set', port, 'master', SWITCH, 'up')
        do('-n', host, 'address', 'add', f'10.77.0.{number}/24', 'dev', 'cable')
        for device in ('lo', 'cable'):
            do('-n', host, 'link', 'set', device, 'up', 'multicast', 'on')


def _wait_for_cable(host: str) -> None:
    """Wait until a host's end of the cable is up and its addresses are its own.

    Fast DDS looks at the network when a node starts, and only then: it never uses a device that
    came up later.
    """
    while True:
        shown = ip('-n', host, 'address', 'show', 'dev', 'cable')
        assert shown.returncode == 0, shown.stderr
        if 'state UP' in shown.stdout and 'tentative' not in shown.stdout:
            return
        time.sleep(0.05)
