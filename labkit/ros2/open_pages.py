"""Which notebooks are open in a page: the Jupyter servers of this account know it."""

from __future__ import annotations

import http.client
import json
import os
import urllib.request
from contextlib import suppress
from pathlib import Path
from typing import Any

from labkit.files import read_limited

__all__ = ['notebooks_in_pages']

# A server that is busy for longer is asked for nothing.
_ANSWER_SEC = 1.0
_LARGEST = 1_000_000
LOOPBACK, ANY = '127.0.0.1', '0.0.0.0'


def notebooks_in_pages() -> dict[str, bool]:
    """Return the notebooks with a kernel, by their files' names, and whether a page shows each.

    A server that does not answer, or wants more than its token, as on a hub, tells nothing.
    """
    import psutil  # type: ignore[import-untyped]
    from jupyter_core.paths import jupyter_runtime_dir

    shown: dict[str, bool] = {}
    for note in Path(jupyter_runtime_dir()).glob('jpserver-*.json'):
        # What others write is not trusted to have its shape.
        with suppress(
            OSError, http.client.HTTPException, ValueError, LookupError, TypeError, psutil.Error
        ):
            server = json.loads(read_limited(note))
            url = f'http://{_address(server["pid"], server["port"])}{server["base_url"]}'
            for session in _sessions(url, server['token']):
                name = Path(session['path']).name
                shown[name] = shown.get(name, False) or session['kernel']['connections'] > 0
    return shown


def _address(pid: int, port: int) -> str:
    """Return where a process of this account listens; raise LookupError if it does not.

    The file of a server that was killed stays, and anybody may have its port by now.
    """
    import psutil

    process = psutil.Process(pid)
    listens = [c.laddr for c in process.net_connections('tcp4') if c.status == psutil.CONN_LISTEN]
    if process.uids().real != os.getuid() or not {*listens} & {(LOOPBACK, port), (ANY, port)}:
        raise LookupError(port)
    return f'{LOOPBACK}:{port}'


def _sessions(url: str, token: str) -> Any:
    request = urllib.request.Request(
        f'{url}api/sessions', headers={'Authorization': f'token {token}'}
    )
    # The server is on this machine: a proxy must not get its token.
    browser = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with browser.open(request, timeout=_ANSWER_SEC) as answer:
        return json.loads(answer.read(_LARGEST))
