"""Logging in on a hub: passwords of the class, compared without holding up the hub."""

from __future__ import annotations

import asyncio
import dbm
from typing import Any

import bcrypt
from firstuseauthenticator import FirstUseAuthenticator  # type: ignore[import-untyped]
from firstuseauthenticator.firstuseauthenticator import (  # type: ignore[import-untyped]
    ResetPasswordHandler,
)
from jupyterhub.handlers import LoginHandler
from jupyterhub.orm import Role, object_session
from traitlets import Set

__all__ = ['LONGEST', 'TEACHER', 'ClassAuthenticator']

TEACHER = 'teacher'
"""The role of teachers."""
LONGEST = 72
"""How many bytes of a password bcrypt takes."""
# Somebody who is not of the class takes as long as a wrong password.
_NOBODY = bcrypt.hashpw(b'', bcrypt.gensalt())


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

    async def authenticate(self, handler: Any, data: dict[str, str]) -> str | None:
        """Return the name of who logs in, None if name and password don't fit.

        Args:
            handler: The request.
            data: Name and password.
        """
        name = self.normalize_username(data['username'])
        password = data['password'].encode()
        with dbm.open(self.dbm_path, 'c', 0o600) as hashes:
            stored = hashes.get(name.encode())
        known = stored is not None and len(password) <= LONGEST
        right = await asyncio.to_thread(
            bcrypt.checkpw, password[:LONGEST], stored if stored is not None else _NOBODY
        )
        return name if known and right else None

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

    def delete_user(self, user: Any) -> None:
        """Keep name and password: who may log in says the list of the class.

        Deleting a user ends their sessions, tokens and server.

        Args:
            user: Who is deleted.
        """

    def get_handlers(self, app: Any) -> list[tuple[str, type]]:
        """Return the pages for logging in and for changing one's password.

        The first is JupyterHub's own: that of jupyterhub-firstuseauthenticator (1.1) can't show
        what is wrong with a form that was open for long.
        """
        return [(r'/login', LoginHandler), (r'/auth/change-password', _ChangePassword)]
