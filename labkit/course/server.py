"""JupyterLab in this process, with a quiet log: its address, and what is wrong, each once.

The kernel of a notebook starts as soon as its page is asked for, that of the notebook on which
JupyterLab opens with the server: while the page is loaded, which takes longer, it gets ready, and
loads what the first cell of a lesson needs.

It is run by its path and imports nothing of labkit: what labkit sets for ROS is for kernels, not
for the terminals that JupyterLab starts.
"""

from __future__ import annotations

import json
import logging
import re
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from queue import Empty
from typing import Any
from urllib.parse import unquote

__all__ = ['Quiet', 'main']

_ADDRESS = re.compile(r'\s*(https?://\S+)\s*')
# What tornado puts right by itself at each connection, and what is so with each fresh lesson.
_NO_MATTER = re.compile(r'The websocket_ping_timeout|Notebook .* is not trusted')
# The page of a notebook.
_PAGE = re.compile(r'.*/lab/tree/(.+\.ipynb)')
_KERNEL = 'python3'
# It leaves no name behind.
_PRELOAD = "if __import__('labkit.background.runtime'): pass"
_PRELOAD_SEC = 60.0
_LOGGERS = (
    *('ServerApp', 'LabApp', 'LabServerApp', 'ExtensionApp'),
    *('tornado.access', 'tornado.application', 'tornado.general'),
)


class Quiet(logging.Filter):
    """Let warnings and errors pass, each of them once, and print the address alone on a line."""

    def __init__(self) -> None:
        super().__init__()
        self._passed: set[str] = set()
        self._told = False

    def filter(self, record: logging.LogRecord) -> bool:
        """Tell whether a line of the log is to be shown."""
        text = record.getMessage()
        address = _ADDRESS.fullmatch(text)
        if address and not self._told:
            self._told = True
            print(f'\n    {address[1]}\n', flush=True)
        # The address comes once more, with what to do about it.
        known = 'token=' in text or text in self._passed
        if known or _NO_MATTER.match(text) or record.levelno < logging.WARNING:
            return False
        self._passed.add(text)
        return True


def main(arguments: Sequence[str]) -> None:
    """Run JupyterLab to its end.

    Args:
        arguments: Its options. With `--debug`, or a level of the log, nothing is held back.
    """
    from jupyterlab.labapp import LabApp

    # Its options and its log are called by this name.
    class ServerApp(LabApp.serverapp_class):  # type: ignore[misc]
        def start_app(self) -> None:
            super().start_app()
            self._starting: set[str] = set()
            log = self.web_app.settings['log_function']

            def follow(handler: Any) -> None:
                log(handler)
                if handler.get_status() == 200 and (page := _PAGE.fullmatch(handler.request.path)):
                    self.io_loop.add_callback(self._start_kernel, unquote(page[1]))

            self.web_app.settings['log_function'] = follow
            self.io_loop.add_callback(
                self._start_kernel, self.default_url.partition('/lab/tree/')[2]
            )

        async def _start_kernel(self, path: str) -> None:
            # The page takes the kernel that its notebook has. What fails here, it says.
            if path in self._starting or _kernel_of(Path(self.root_dir, path)) != _KERNEL:
                return
            self._starting.add(path)
            try:
                if not await self.session_manager.session_exists(path=path):
                    await self._start_ready(path)
            finally:
                self._starting.remove(path)

        async def _start_ready(self, path: str) -> None:
            session = await self.session_manager.create_session(
                path=path, name=path.rpartition('/')[2], type='notebook', kernel_name=_KERNEL
            )
            client = self.kernel_manager.get_kernel(session['kernel']['id']).client()
            client.start_channels(iopub=False, stdin=False, control=False, hb=False)
            client.execute(_PRELOAD, silent=True, store_history=False)
            with suppress(Empty):  # it has ended meanwhile
                await client.get_shell_msg(timeout=_PRELOAD_SEC)
            client.stop_channels()

    LabApp.serverapp_class = ServerApp
    if not any(re.match(r'--debug$|--(\w+\.)?log[-_]level', word) for word in arguments):
        quiet = Quiet()
        for name in _LOGGERS:
            logging.getLogger(name).addFilter(quiet)
    LabApp.launch_instance(list(arguments))


def _kernel_of(notebook: Path) -> str:
    """Return the name of a notebook's kernel; '' if it is none, or can't be read."""
    try:
        metadata = json.loads(notebook.read_text(encoding='utf-8'))['metadata']
        return str(metadata.get('kernelspec', {}).get('name', _KERNEL))
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return ''


if __name__ == '__main__':
    main(sys.argv[1:])
