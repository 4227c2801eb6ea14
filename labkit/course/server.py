"""JupyterLab in this process, with a quiet log: its address, and what is wrong, each once.

The kernel of a notebook starts as soon as its page is asked for, that of the notebook on which
JupyterLab opens with the server: while the page is loaded, which takes longer, it gets ready, and
loads what the first cells of a lesson need. The first page of all finds its notebook in the
workspace, too: JupyterLab opens what lies there at once, what its address names a second later.

It is run by its path and imports nothing of labkit: what labkit sets for ROS is for kernels, not
for the terminals that JupyterLab starts.
"""

from __future__ import annotations

import asyncio
import functools
import json
import logging
import re
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from queue import Empty
from typing import Any
from urllib.parse import unquote

__all__ = ['Quiet', 'main']

_ADDRESS = re.compile(r'\s*(https?://\S+)\s*')
_TOKEN = re.compile(r'token=\w+')
# What tornado puts right by itself at each connection, and what is so with each fresh lesson.
_NO_MATTER = re.compile(r'The websocket_ping_timeout|Notebook .* is not trusted')
# The page of a notebook.
_PAGE = re.compile(r'.*/lab/tree/(.+\.ipynb)')
_WORKSPACE = 'default'
_KERNEL = 'python3'
# ROS, exercises and views: what the first cells of each lesson load. It leaves no name behind.
_PRELOADED = ('labkit.background.runtime', 'labkit.exercises.lesson', 'labkit.views.live_page')
_PRELOAD = f'if all(map(__import__, {_PRELOADED})): pass'
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
        if record.exc_info:
            # What went wrong is shown, with the request, and without the token in its address.
            text = record.msg = _TOKEN.sub('token=...', text)
            record.args = ()
        # The address comes once more, with what to do about it.
        known = _TOKEN.search(text) or text in self._passed
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
    from jupyterlab_server.workspaces_handler import WorkspacesManager

    # Its options and its log are called by this name.
    class ServerApp(LabApp.serverapp_class):  # type: ignore[misc]
        def start_app(self) -> None:
            super().start_app()
            self._starting: dict[str, asyncio.Task[Any]] = {}
            log = self.web_app.settings['log_function']

            def follow(handler: Any) -> None:
                log(handler)
                if handler.get_status() == 200 and (page := _PAGE.fullmatch(handler.request.path)):
                    path = unquote(page[1])
                    self._open_at_once(path)
                    self.io_loop.add_callback(self._start_kernel, path)

            self.web_app.settings['log_function'] = follow
            # Nothing is built from source here, so that no page has to ask whether it should be.
            page = self.web_app.settings.setdefault('page_config_data', {})
            page.update(buildAvailable=False, buildCheck=False)
            self.io_loop.run_in_executor(None, _load_exporters)
            self.io_loop.add_callback(
                self._start_kernel, self.default_url.partition('/lab/tree/')[2]
            )

        def _open_at_once(self, path: str) -> None:
            [lab] = self.extension_manager.extension_apps['jupyterlab']
            workspaces = WorkspacesManager(lab.workspaces_dir)
            # What can't be read or written here, the page says, or does without.
            with suppress(OSError, ValueError):
                if Path(self.root_dir, path).is_file() and not workspaces.load(_WORKSPACE)['data']:
                    workspaces.save(_WORKSPACE, json.dumps(_workspace(path)))

        async def _start_kernel(self, path: str) -> None:
            # The page takes the kernel that its notebook has. What fails here, it says.
            if path in self._starting or _kernel_of(Path(self.root_dir, path)) != _KERNEL:
                return
            self._starting[path] = asyncio.create_task(self._create_session(path))
            try:
                session = await self._starting[path]
            finally:
                del self._starting[path]
            if session is not None:
                await self._make_ready(session['kernel']['id'])

        async def _create_session(self, path: str) -> dict[str, Any] | None:
            if self._stopping or await self.session_manager.session_exists(path=path):
                return None
            session: dict[str, Any] = await self.session_manager.create_session(
                path=path, name=path.rpartition('/')[2], type='notebook', kernel_name=_KERNEL
            )
            return session

        async def _make_ready(self, kernel_id: str) -> None:
            client = self.kernel_manager.get_kernel(kernel_id).client()
            client.start_channels(iopub=False, stdin=False, control=False, hb=False)
            client.execute(_PRELOAD, silent=True, store_history=False)
            with suppress(Empty):  # it has ended meanwhile
                await client.get_shell_msg(timeout=_PRELOAD_SEC)
            client.stop_channels()

        async def cleanup_kernels(self) -> None:
            # A kernel that has not quite started can't be ended, and the server would stay.
            await asyncio.gather(*self._starting.values(), return_exceptions=True)
            await super().cleanup_kernels()

    LabApp.serverapp_class = ServerApp
    if not any(re.match(r'--debug$|--(\w+\.)?log[-_]level', word) for word in arguments):
        quiet = Quiet()
        for name in _LOGGERS:
            logging.getLogger(name).addFilter(quiet)
    LabApp.launch_instance(list(arguments))


def _load_exporters() -> None:
    """Load what a page asks for while it opens: into which formats a notebook can be exported."""
    with suppress(Exception):  # what is wrong with one, the menu says
        base: Any = import_module('nbconvert.exporters.base')
        # It reads what all packages have installed, anew for each of the formats.
        base.entry_points = functools.cache(base.entry_points)
        for name in base.get_export_names():
            base.get_exporter(name)


def _workspace(path: str) -> dict[str, Any]:
    """Return the workspace that JupyterLab saves itself when a notebook is all that is open."""
    tab = f'notebook:{path}'
    dock = {'type': 'tab-area', 'currentIndex': 0, 'widgets': [tab]}
    files = {'collapsed': False, 'visible': True, 'current': 'filebrowser'}
    return {
        'data': {
            'layout-restorer:data': {'main': {'dock': dock, 'current': tab}, 'left': files},
            tab: {'data': {'path': path, 'factory': 'Notebook'}},
        },
        'metadata': {'id': _WORKSPACE},
    }


def _kernel_of(notebook: Path) -> str:
    """Return the name of a notebook's kernel; '' if it is none, or can't be read."""
    try:
        metadata = json.loads(notebook.read_text(encoding='utf-8'))['metadata']
        return str(metadata.get('kernelspec', {}).get('name', _KERNEL))
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return ''


if __name__ == '__main__':
    main(sys.argv[1:])
