"""JupyterLab in this process, with a quiet log: the address, and each problem once.

The kernel of a notebook starts when its page is requested, that of the first notebook with the
server: it gets ready while the page loads, which takes longer, and loads what the first cells of a
    lesson need. The first page finds its notebook in the workspace, too: JupyterLab opens
    notebooks of the workspace at once, those of its address a second later.

It is run by its path and imports nothing of labkit: labkit's settings for ROS are for kernels, not
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
# Warnings that tornado fixes by itself, or that come with every fresh lesson.
_IGNORED = re.compile(r'The websocket_ping_timeout|Notebook .* is not trusted')
# The address of a notebook's page.
_PAGE = re.compile(r'.*/lab/tree/(.+\.ipynb)')
_WORKSPACE = 'default'
_KERNEL = 'python3'
# ROS, exercises and views, which every lesson needs. The code defines no names.
_PRELOADED = ('labkit.background.runtime', 'labkit.exercises.setup_cell', 'labkit.views.live_page')
_PRELOAD = f'if all(map(__import__, {_PRELOADED})): pass'
_PRELOAD_SEC = 60.0
_LOGGERS = (
    *('ServerApp', 'LabApp', 'LabServerApp', 'ExtensionApp'),
    *('tornado.access', 'tornado.application', 'tornado.general'),
)


class Quiet(logging.Filter):
    """Passes warnings and errors once each, and prints the address alone on a line."""

    def __init__(self) -> None:
        super().__init__()
        self._passed: set[str] = set()
        self._printed = False

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether to show a line of the log."""
        text = record.getMessage()
        address = _ADDRESS.fullmatch(text)
        if address and not self._printed:
            self._printed = True
            print(f'\n    {address[1]}\n', flush=True)
        if record.exc_info:
            # Show the error with the request, but without the token in its address.
            text = record.msg = _TOKEN.sub('token=...', text)
            record.args = ()
        # The address is logged again, with instructions.
        known = _TOKEN.search(text) or text in self._passed
        if known or _IGNORED.match(text) or record.levelno < logging.WARNING:
            return False
        self._passed.add(text)
        return True


def main(arguments: Sequence[str]) -> None:
    """Run JupyterLab until it ends.

    Args:
        arguments: Its options. With `--debug`, or a log level, nothing is filtered.
    """
    from jupyterlab.labapp import LabApp
    from jupyterlab_server.workspaces_handler import WorkspacesManager

    # JupyterLab's options and logger use this class name.
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
            # Nothing is built from source, so pages need not ask whether to rebuild.
            page = self.web_app.settings.setdefault('page_config_data', {})
            page.update(buildAvailable=False, buildCheck=False)
            self.io_loop.run_in_executor(None, _load_exporters)
            self.io_loop.add_callback(
                self._start_kernel, self.default_url.partition('/lab/tree/')[2]
            )

        def _open_at_once(self, path: str) -> None:
            [lab] = self.extension_manager.extension_apps['jupyterlab']
            workspaces = WorkspacesManager(lab.workspaces_dir)
            # The page reports or ignores what can't be read or written here.
            with suppress(OSError, ValueError):
                if Path(self.root_dir, path).is_file() and not workspaces.load(_WORKSPACE)['data']:
                    workspaces.save(_WORKSPACE, json.dumps(_workspace(path)))

        async def _start_kernel(self, path: str) -> None:
            # The page uses its notebook's kernel, and reports what fails here.
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
            with suppress(Empty):  # it has ended
                await client.get_shell_msg(timeout=_PRELOAD_SEC)
            client.stop_channels()

        async def cleanup_kernels(self) -> None:
            # A kernel that is still starting can't be ended, and the server would hang.
            await asyncio.gather(*self._starting.values(), return_exceptions=True)
            await super().cleanup_kernels()

    LabApp.serverapp_class = ServerApp
    if not any(re.match(r'--debug$|--(\w+\.)?log[-_]level', word) for word in arguments):
        quiet = Quiet()
        for name in _LOGGERS:
            logging.getLogger(name).addFilter(quiet)
    LabApp.launch_instance(list(arguments))


def _load_exporters() -> None:
    """Load what a page requests while it opens: the export formats of notebooks."""
    with suppress(Exception):  # the menu reports a broken one
        base: Any = import_module('nbconvert.exporters.base')
        # It reads the metadata of all packages anew for each format.
        base.entry_points = functools.cache(base.entry_points)
        for name in base.get_export_names():
            base.get_exporter(name)


def _workspace(path: str) -> dict[str, Any]:
    """Return the workspace that JupyterLab itself saves when only a notebook is open."""
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
    """Return the name of a notebook's kernel; '' if it has none, or can't be read."""
    if not notebook.is_file():
        return ''  # reading a pipe would block
    try:
        metadata = json.loads(notebook.read_text(encoding='utf-8'))['metadata']
        return str(metadata.get('kernelspec', {}).get('name', _KERNEL))
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return ''


if __name__ == '__main__':
    main(sys.argv[1:])
