"""Which notebooks are open in a page: the Jupyter servers of this account know it."""

from __future__ import annotations

import http.client
import json
import urllib.request
from contextlib import suppress
from pathlib import Path
from typing import Any

from labkit.files import read_limited

__all__ = ['notebooks_in_pages']

# A server that is busy for longer is asked for nothing.
_ANSWER_SEC = 1.0
_LARGEST = 1_000_000


def notebooks_in_pages() -> dict[str, bool]:
    """Return the notebooks with a kernel, by their files' names, and whether a page shows each.

    A server that does not answer, or wants more than its token, as on a hub, tells nothing.
    """
    from jupyter_core.paths import jupyter_runtime_dir

    shown: dict[str, bool] = {}
    for note in Path(jupyter_runtime_dir()).glob('jpserver-*.json'):
        # What others write is not trusted to have its shape.
        with suppress(OSError, http.client.HTTPException, ValueError, LookupError, TypeError):
            server = json.loads(read_limited(note))
            for session in _sessions(server['url'], server['token']):
                name = Path(session['path']).name
                shown[name] = shown.get(name, False) or session['kernel']['connections'] > 0
    return shown


def _sessions(url: str, token: str) -> Any:
    request = urllib.request.Request(
        f'{url}api/sessions', headers={'Authorization': f'token {token}'}
    )
    # The server is on this machine: a proxy must not get its token.
    browser = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with browser.open(request, timeout=_ANSWER_SEC) as answer:
        return json.loads(answer.read(_LARGEST))
