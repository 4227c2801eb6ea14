"""What forked processes print comes to the kernel by a socket beside its channels, not by a port.

ipykernel listens at a port of this machine for it, also where the channels are sockets in the
owner's home, as on a hub: there any account could send messages without end. Where the channels
are ports, this changes nothing.

Each kernel of the environment reads this, before it makes its channels. It imports nothing of
labkit, since a notebook may do without. The private names have a contract test in
tests/background/test_compat.py.
"""

import os
from typing import Any

import zmq
from ipykernel import kernelapp
from ipykernel.iostream import IOPubThread
from zmq.eventloop.zmqstream import ZMQStream


class _SocketThread(IOPubThread):
    """The thread that publishes what the kernel shows, and what its forked processes print."""

    _pipe = ''

    def _setup_pipe_in(self) -> None:
        channel = self.socket.getsockopt_string(zmq.LAST_ENDPOINT)
        if not channel.startswith('ipc://'):
            super()._setup_pipe_in()  # type: ignore[no-untyped-call]
            return
        # As long as the channels' own, whose length is limited: `ipc:///home/anna/.../kernel-2`.
        self._pipe = channel.rpartition('-')[0] + '-p'
        self._pipe_uuid = os.urandom(16)
        socket = self.socket.context.socket(zmq.PULL)
        socket.linger = 0
        socket.bind(self._pipe)
        self._pipe_in = ZMQStream(socket, self.io_loop)
        self._pipe_in.on_recv(self._handle_pipe_msg)

    def _setup_pipe_out(self) -> tuple[Any, Any]:
        if not self._pipe:
            return super()._setup_pipe_out()  # type: ignore[no-untyped-call,no-any-return]
        context = zmq.Context()
        socket = context.socket(zmq.PUSH)
        socket.linger = 3000  # ms, as ipykernel's
        socket.connect(self._pipe)
        return context, socket


kernelapp.IOPubThread = _SocketThread  # type: ignore[attr-defined]
