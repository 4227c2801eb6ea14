"""A port for a server that a test starts."""

from __future__ import annotations

import random
import socket
from pathlib import Path

__all__ = ['free_port']

# What Linux gives to whoever asks for any port: a kernel takes five of them, a browser dozens.
_RANGE = Path('/proc/sys/net/ipv4/ip_local_port_range')


def free_port() -> int:
    """Return a port that nobody uses, and that nobody is given until the server has it."""
    first = int(_RANGE.read_text().split()[0])
    while True:
        port = random.randrange(first // 2, first)
        with socket.socket() as probe:
            try:
                probe.bind(('127.0.0.1', port))
            except OSError:
                continue
        return port
