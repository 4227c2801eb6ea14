"""A Jupyter kernel to measure in."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import time
from queue import Empty

import psutil
from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import KernelManager

__all__ = ['Kernel']

TIMEOUT_SEC = 300


class Kernel:
    """A kernel in a process of its own, for as long as a `with` block lasts."""

    def __enter__(self) -> Kernel:
        """Start it."""
        self._folder = tempfile.TemporaryDirectory()
        # No folder of kernel specs: 'python3' is then the Python that runs this.
        self._manager = KernelManager(
            kernel_name='python3', kernel_spec_manager=KernelSpecManager(kernel_dirs=[])
        )
        home = {'LABKIT_HOME': self._folder.name, 'IPYTHONDIR': self._folder.name}
        self._manager.start_kernel(
            cwd=self._folder.name, env={**os.environ, **home}, stderr=subprocess.DEVNULL
        )
        self._client = self._manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=TIMEOUT_SEC)
        self.process = psutil.Process(self._manager.provisioner.process.pid)
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        self._client.stop_channels()
        self._manager.shutdown_kernel()
        self._folder.cleanup()

    def run(self, code: str) -> str:
        """Run a cell; return what it prints.

        Raises:
            RuntimeError: It raised.
        """
        texts: list[str] = []

        def collect(message: dict) -> None:
            if message['msg_type'] == 'stream':
                texts.append(message['content']['text'])

        reply = self._client.execute_interactive(
            code, output_hook=collect, timeout=TIMEOUT_SEC, allow_stdin=False
        )
        if reply['content']['status'] != 'ok':
            raise RuntimeError('\n'.join(reply['content']['traceback']))
        return ''.join(texts)

    def comm_messages(self, seconds: float) -> list[int]:
        """Return the sizes in bytes of what goes to the page's widgets in the next `seconds`."""
        sizes = []
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                message = self._client.get_iopub_msg(timeout=0.05)
            except Empty:
                continue
            if message['msg_type'] == 'comm_msg':
                text = json.dumps(message['content'])
                sizes.append(len(text) + sum(map(len, message['buffers'])))
        return sizes

    def cpu_share(self, seconds: float) -> float:
        """Return the share of a core that it uses in the next `seconds`, in per cent."""
        before, start = sum(self.process.cpu_times()[:2]), time.monotonic()
        time.sleep(seconds)
        used = sum(self.process.cpu_times()[:2]) - before
        return 100 * used / (time.monotonic() - start)

    def memory(self) -> float:
        """Return its resident memory in MB."""
        return self.process.memory_info().rss / 1e6
