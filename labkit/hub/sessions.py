"""End all that a member has of a running hub: sessions, tokens, the server, and processes."""

from __future__ import annotations

import json
import secrets
import ssl
import time
import urllib.error
import urllib.request
from pathlib import Path

from labkit.errors import LabError
from labkit.files import write_atomically
from labkit.hub.accounts import end_processes

__all__ = ['end_all', 'note_hub', 'noted_hub']

# How the hub is reached, in its folder, which only root reads.
_NOTE = 'hub.json'
# The hub's own certificate and whom it trusts, where JupyterHub keeps them.
_CERTIFICATES = Path('internal-ssl', 'hub-internal')
_AUTHORITY = Path('internal-ssl', 'hub-ca', 'hub-ca.crt')
# As long as a server may take to start or end.
_LONGEST_SEC = 180


def note_hub(folder: Path, address: str) -> str:
    """Note where the hub will be reached; return a new token for who may read that.

    Args:
        folder: The hub's folder.
        address: Such as `https://127.0.0.1:801`.
    """
    token = secrets.token_hex(32)
    note = json.dumps({'api': f'{address}/hub/api', 'token': token})
    write_atomically(folder / _NOTE, note.encode(), mode=0o600)
    return token


def noted_hub(folder: Path) -> str:
    """Return where the hub was reached when it was started last, '' if it never was."""
    try:
        return str(json.loads((folder / _NOTE).read_bytes())['api']).removesuffix('/hub/api')
    except (OSError, ValueError, LookupError, TypeError):
        return ''


def end_all(folder: Path, name: str, *, account: bool) -> None:
    """End somebody's sessions, tokens, server and processes.

    A hub forgets sessions and tokens with their user, who is made anew at the next login.

    Args:
        folder: The hub's folder.
        name: Who it is.
        account: Whether their server runs in an account of this machine.

    Raises:
        LabError: The hub can't be reached, or does not do it.
    """
    end = time.monotonic() + _LONGEST_SEC
    while (status := _delete(folder, f'users/{name}')) not in (204, 404):
        # The server starts or ends just now, maybe because the other one is still in.
        _delete(folder, f'users/{name}/server')
        if time.monotonic() > end:
            raise LabError(
                f'The hub does not end what {name} has: it answers with status {status}.',
                todo='Look at what the hub prints, and repeat the command.',
            )
        time.sleep(0.1)
    if account:
        end_processes(name)


def _delete(folder: Path, path: str) -> int:
    """Ask the hub to delete something; return the status of its answer."""
    try:
        note = json.loads((folder / _NOTE).read_bytes())
        request = urllib.request.Request(
            f'{note["api"]}/{path}',
            method='DELETE',
            headers={'Authorization': f'token {note["token"]}'},
        )
        browser = urllib.request.build_opener(
            urllib.request.ProxyHandler({}),
            urllib.request.HTTPSHandler(context=_encrypted(folder)),
        )
        with browser.open(request, timeout=_LONGEST_SEC) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        return error.code
    except OSError as error:
        raise LabError(
            f'The hub of {str(folder)!r} can not be reached: {error}.',
            todo='Start it, and repeat the command in another terminal: the hub ends sessions '
            'that were opened with the old password.',
        ) from error


def _encrypted(folder: Path) -> ssl.SSLContext | None:
    certificates = folder / _CERTIFICATES
    if not certificates.exists():
        return None  # containers
    context = ssl.create_default_context(cafile=str(folder / _AUTHORITY))
    own = certificates / certificates.name
    context.load_cert_chain(own.with_suffix('.crt'), own.with_suffix('.key'))
    return context
