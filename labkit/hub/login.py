"""Logging in on a hub: passwords of the class, compared without holding up the hub."""

from __future__ import annotations

import asyncio
import dbm
import hashlib
from typing import Any

import bcrypt
from firstuseauthenticator import FirstUseAuthenticator  # type: ignore[import-untyped]
from firstuseauthenticator.firstuseauthenticator import (  # type: ignore[import-untyped]
    ResetPasswordHandler,
)
from jupyterhub.handlers import LoginHandler
from jupyterhub.orm import Role, object_session
from tornado.web import HTTPError
from traitlets import Set

from labkit.hub.guesses import Guesses, TooManyError

__all__ = ['LONGEST', 'TEACHER', 'ClassAuthenticator']

TEACHER = 'teacher'
"""The role of teachers."""
LONGEST = 72
"""How many bytes of a password bcrypt takes."""
_NOBODY = bcrypt.hashpw(b'', bcrypt.gensalt())
# The cookie of a browser with which somebody has logged in, and how long it is good for, days.
_COOKIE, _COOKIE_DAYS = 'labkit-known', 365
# More than a name of the class has.
_LONGEST_NAME = 32


class _ChangePassword(ResetPasswordHandler):  # type: ignore[misc]
    """The page to change one's password, which asks for the old one."""

    async def post(self) -> None:
        """Change it if the old one is right."""
        if self.current_user is None:
            self.send_error(403)
            return
        old = self.get_body_argument('old_password', '', strip=False)
        data = {'username': self.current_user.name, 'password': old}
        if await self.authenticator.authenticate(self, data) is None:
            message = 'The old password is wrong.'
        else:
            new = self.get_body_argument('password', strip=False)
            message = self.authenticator.reset_password(self.current_user.name, new)
        self._register_template_path()
        alert = 'success' if 'success' in message else 'danger'
        self.finish(
            await self.render_template(
                'reset.html', result=True, alert=alert, result_message=message
            )
        )


class ClassAuthenticator(FirstUseAuthenticator):  # type: ignore[misc]
    """Lets in whose password is right. There is none that the first to come may choose."""

    teachers = Set(help='Who teaches.').tag(config=True)

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._guesses = Guesses()
        self._strangers = asyncio.Lock()

    async def authenticate(self, handler: Any, data: dict[str, str]) -> str | None:
        """Return the name of who logs in, None if name and password don't fit.

        Args:
            handler: The request.
            data: Name and password.

        Raises:
            HTTPError: Too many others try passwords of this account just now.
        """
        name = str(self.normalize_username(data['username']))[:_LONGEST_NAME]
        shown = handler.get_signed_cookie(_COOKIE, max_age_days=_COOKIE_DAYS)
        known = shown == _mark(name, self._stored(name))
        who = {'name': name, 'address': _address(handler.request), 'known': known}
        try:
            async with self._guesses.turn(**who):
                stored = self._stored(name)  # which may be another one by now
                if not await self._compare(data['password'].encode(), stored):
                    self._guesses.note_wrong(**who)
                    return None
        except TooManyError:
            raise HTTPError(
                429, 'Many passwords are tried for this account just now. Try again in a minute.'
            ) from None
        handler.set_signed_cookie(
            *(_COOKIE, _mark(name, stored), _COOKIE_DAYS),
            path=handler.hub.base_url,
            httponly=True,
            samesite='Lax',
            secure=handler.request.protocol == 'https',
        )
        return name

    def _stored(self, name: str) -> bytes | None:
        with dbm.open(self.dbm_path, 'c', 0o600) as hashes:
            return hashes.get(name.encode())

    async def _compare(self, password: bytes, stored: bytes | None) -> bool:
        """Return whether a password is the stored one, beside the hub's other work."""
        short = password[:LONGEST]
        if stored is None:
            # As long as a wrong password takes, but one at a time: names can be made up without
            # end, and those who have one would wait for a processor.
            async with self._strangers:
                await asyncio.to_thread(bcrypt.checkpw, short, _NOBODY)
            return False
        return await asyncio.to_thread(bcrypt.checkpw, short, stored) and short == password

    def reset_password(self, username: str, new_password: str) -> str:
        """Change a password; return what to tell the person.

        Args:
            username: Who is logged in.
            new_password: What they have chosen.
        """
        if len(new_password.encode()) > LONGEST:
            return (
                f'Password too long! Please choose one of up to {LONGEST} bytes: a letter with an '
                'accent has two.'
            )
        return str(super().reset_password(username, new_password))

    def add_user(self, user: Any) -> None:
        """Make a teacher of who is one in the list, and an admin of nobody: see `load_roles`.

        Args:
            user: Somebody whom the hub knows at its start, or gets to know at a login.
        """
        super().add_user(user)
        user.admin = False
        role = Role.find(object_session(getattr(user, 'orm_user', user)), TEACHER)
        if role is not None and user.name in self.teachers and role not in user.roles:
            user.roles.append(role)

    async def refresh_user(self, user: Any, handler: Any = None) -> bool:
        """Return whether a session goes on: not of somebody who is taken out of the list.

        Args:
            user: Who has logged in at some time, maybe before the hub was started.
            handler: The request.
        """
        return user.name in self.allowed_users

    def delete_user(self, user: Any) -> None:
        """Keep name and password: who may log in says the list of the class.

        Deleting a user ends their sessions, tokens and server.

        Args:
            user: Who is deleted.
        """

    def get_handlers(self, app: Any) -> list[tuple[str, type]]:
        """Return the pages for logging in and for changing one's password."""
        return [(r'/login', LoginHandler), (r'/auth/change-password', _ChangePassword)]


def _mark(name: str, stored: bytes | None) -> bytes:
    """Return what the cookie says: once the password is another one, it is of no use."""
    return f'{name}:{hashlib.sha256(stored or b"").hexdigest()}'.encode()


def _address(request: Any) -> str:
    """Return where a request comes from, as the proxy has seen it.

    What stands before that, and in other headers, anybody can write.
    """
    seen = request.headers.get('X-Forwarded-For', '').rpartition(',')[2].strip()
    return str(seen or request.remote_ip)
