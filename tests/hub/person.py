"""Somebody of the class, in front of a browser: logs in, starts a server, runs cells."""

from __future__ import annotations

import json
import ssl
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
import uuid
from collections.abc import Callable, Collection
from contextlib import closing
from dataclasses import dataclass
from http.cookiejar import CookieJar
from typing import Any

import websocket
from hub.machine import START_SEC, Hub

JSON = 'application/json'


@dataclass(frozen=True)
class Answer:
    """What a server answers: its status, where the way led, and the text."""

    status: int
    address: str
    text: str


class Person:
    """Somebody who uses the hub by its pages and its interface, as a browser does.

    Args:
        hub: The hub.
        name: Who it is.
        https: What a connection is encrypted with, None for not at all.
    """

    def __init__(self, hub: Hub, name: str, https: ssl.SSLContext | None = None) -> None:
        self.name = name
        self.token = ''
        self._hub = hub
        self._url = f'http{"s" * bool(https)}://127.0.0.1:{hub.port}'
        self._cookies = CookieJar()
        handlers: list[urllib.request.BaseHandler] = [
            urllib.request.ProxyHandler({}),
            urllib.request.HTTPCookieProcessor(self._cookies),
        ]
        handlers += [urllib.request.HTTPSHandler(context=https)] if https else []
        self._browser = urllib.request.build_opener(*handlers)

    # --- Pages -----------------------------------------------------------------------------------

    def ask(self, path: str, method: str = 'GET', data: object = None, **headers: str) -> Answer:
        """Ask for a page or for something of an interface, following where it leads."""
        body = None
        if isinstance(data, dict) and headers.get('type') == 'form':
            body = urllib.parse.urlencode(data).encode()
        elif data is not None:
            body = json.dumps(data).encode()
        headers.pop('type', None)
        if self.token:
            headers['Authorization'] = f'token {self.token}'
        request = urllib.request.Request(
            self._url + path, method=method, data=body, headers=headers
        )
        try:
            with self._browser.open(request, timeout=START_SEC) as answer:
                return Answer(answer.status, answer.url, answer.read().decode(errors='replace'))
        except urllib.error.HTTPError as error:
            return Answer(error.code, error.url or '', error.read().decode(errors='replace'))

    def log_in(self, password: str | None = None, **headers: str) -> Answer:
        """Fill in the form of the login page."""
        self.ask('/hub/login', **headers)
        fields = {
            'username': self.name,
            'password': password or self._hub.password(self.name),
            '_xsrf': self._cookie('_xsrf'),
        }
        return self.ask('/hub/login', 'POST', fields, type='form', **headers)

    def get_token(self) -> None:
        """Let the hub make a token for one's own scripts, which is used from here on."""
        headers = {'X-XSRFToken': self._cookie('_xsrf'), 'Content-Type': JSON}
        headers['Referer'] = f'{self._url}/hub/token'
        answer = self.ask(f'/hub/api/users/{self.name}/tokens', 'POST', {}, **headers)
        assert answer.status == 201, answer
        self.token = json.loads(answer.text)['token']

    def _cookie(self, name: str) -> str:
        """Return the cookie for pages of the hub."""
        found = [one for one in self._cookies if one.name == name]
        return next((str(one.value) for one in found if one.path == '/hub/'), '')

    # --- One's own server ------------------------------------------------------------------------

    def api(self, path: str, method: str = 'GET', data: object = None, of: str = '') -> Any:
        """Ask a server, one's own if it is not said whose, and return what it says."""
        answer = self.ask(f'/user/{of or self.name}/api/{path}', method, data)
        assert answer.status < 400, answer
        return json.loads(answer.text or 'null')

    def start_server(self) -> None:
        """Press the button that starts the server, and wait until it is ready.

        The page after the login starts it, too, and may have come first.
        """
        answer = self.ask(f'/hub/api/users/{self.name}/server', 'POST', {})
        assert answer.status in (201, 202) or 'is already running' in answer.text, answer

        def ready() -> bool:
            user = self.ask(f'/hub/api/users/{self.name}')
            server = json.loads(user.text)['servers'].get('', {})
            return bool(server.get('ready'))

        self._hub.wait(ready, f'the server of {self.name}')

    def open_notebook(self, name: str) -> Notebook:
        """Open a notebook in the server, which starts its kernel."""
        session = self.api(
            'sessions',
            'POST',
            {'path': name, 'name': name, 'type': 'notebook', 'kernel': {'name': 'python3'}},
        )
        kernel_id = session['kernel']['id']
        address = f'{self._url.replace("http", "ws", 1)}/user/{self.name}/api/kernels/{kernel_id}'
        return Notebook(kernel_id, address, self.token)


class Notebook:
    """An open notebook: a kernel, with a connection of its own for each cell that runs.

    Args:
        kernel_id: The kernel.
        address: Its address.
        token: What lets one in.
    """

    def __init__(self, kernel_id: str, address: str, token: str) -> None:
        self.kernel_id = kernel_id
        self._address = f'{address}/channels'
        self._header = [f'Authorization: token {token}']
        self._running: dict[str, tuple[str, websocket.WebSocket]] = {}

    def run(self, code: str, lines: Collection[str] = ()) -> str:
        """Run a cell to its end, and until it shows some lines; return what it shows.

        An error counts, too. Lines of nodes may come after the end of their cell.
        """
        return self.finish(self.start(code), lines)

    def start(self, code: str) -> str:
        """Start a cell and return its request's id."""
        header = {
            'msg_id': uuid.uuid4().hex,
            'msg_type': 'execute_request',
            'username': '',
            'session': 'page',
            'version': '5.3',
        }
        content = {
            'code': code,
            'silent': False,
            'store_history': True,
            'allow_stdin': False,
            'user_expressions': {},
            'stop_on_error': False,
        }
        message = {
            'header': header,
            'parent_header': {},
            'metadata': {},
            'content': content,
            'channel': 'shell',
        }
        connection = websocket.create_connection(
            self._address, timeout=START_SEC, header=self._header
        )
        connection.send(json.dumps(message))
        # Less than the server lets pass between two pings: they would prolong each wait.
        connection.settimeout(5)
        self._running[header['msg_id']] = code, connection
        return header['msg_id']

    def finish(self, request: str, lines: Collection[str] = ()) -> str:
        """Wait for the end of a started cell, and for some lines; return what it shows."""
        shown: list[str] = []
        has_ended = False
        displays: dict[str, int] = {}
        others = 0
        code, connection = self._running.pop(request)
        end = time.monotonic() + START_SEC
        with closing(connection):
            while True:
                assert time.monotonic() < end, (
                    f'no end of {code!r} in {self._address}; '
                    f'shown: {"".join(shown)!r}; other messages: {others}'
                )
                if has_ended and {*lines} <= {*''.join(shown).splitlines()}:
                    return ''.join(shown)
                try:
                    text = connection.recv()
                except websocket.WebSocketTimeoutException:
                    continue
                if isinstance(text, bytes):
                    continue  # a picture for a widget
                message = json.loads(text)
                if message['parent_header'].get('msg_id') != request:
                    others += 1
                    continue
                kind, content = message['msg_type'], message['content']
                has_ended |= kind == 'status' and content['execution_state'] == 'idle'
                if kind == 'stream':
                    shown.append(content['text'])
                elif 'data' in content:
                    text = content['data'].get('text/plain', '')
                    display = content.get('transient', {}).get('display_id', '')
                    # An update takes the place of what a view or a bar has shown before.
                    if kind != 'update_display_data':
                        displays[display] = len(shown)
                        shown.append(text)
                    elif display in displays:
                        shown[displays[display]] = text
                elif kind == 'error':
                    shown.append(f'raised {content["ename"]}: {content["evalue"]}\n')


def at_once(people: list[Person], do: Callable[[Person], Any]) -> dict[str, Any]:
    """Let everybody do the same at once; return what each got, or raise the first error."""
    results: dict[str, Any] = {}
    errors: list[BaseException] = []

    def one(person: Person) -> None:
        try:
            results[person.name] = do(person)
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=one, args=(person,)) for person in people]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]
    return results
