"""Guessed passwords wait, and hold up nobody who knows theirs."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tornado.httputil import HTTPHeaders

from labkit.hub import guesses
from labkit.hub.guesses import Guesses, TooManyError
from labkit.hub.login import ClassAuthenticator, _address
from labkit.hub.passwords import FIRST_PASSWORDS, HASHES, make_passwords

SCHOOL, HOME = '192.0.2.7', '198.51.100.9'


class Clock:
    """A clock that waits move on, and that notes them."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 1000.0
        self.waits: list[float] = []
        monkeypatch.setattr(guesses, 'time', SimpleNamespace(monotonic=lambda: self.now))

    async def sleep(self, seconds: float) -> None:
        self.waits.append(seconds)
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


def request_from(address: str, cookies: dict[str, bytes] | None = None) -> Any:
    """Return a request for the login page, as far as logging in looks at it."""
    jar = {} if cookies is None else cookies
    return SimpleNamespace(
        get_signed_cookie=lambda name, **_: jar.get(name),
        set_signed_cookie=lambda name, value, *_, **__: jar.update({name: value}),
        request=SimpleNamespace(headers=HTTPHeaders(), remote_ip=address, protocol='https'),
        hub=SimpleNamespace(base_url='/hub/'),
    )


async def guess(
    tried: Guesses, name: str = 'anna', address: str = SCHOOL, *, known: bool = False
) -> None:
    """Try a wrong password."""
    async with tried.turn(name, address, known=known):
        tried.note_wrong(name, address, known=known)


def test_each_wrong_password_takes_longer_up_to_a_limit(clock: Clock) -> None:
    async def attack() -> None:
        tried = Guesses(clock.sleep)
        for number in range(11):
            # Another address makes no difference to the account.
            await guess(tried, address=f'192.0.2.{number}')
        assert clock.waits == [0, 0, 0, 0, 0, 1, 2, 4, 8, 8, 8]
        clock.waits.clear()
        await guess(tried, known=True)
        await guess(tried, 'ben')
        clock.now += 1000
        await guess(tried)
        assert clock.waits == [0, 0, 0]

    asyncio.run(attack())


def test_many_names_from_one_address_wait_and_a_class_there_hardly(clock: Clock) -> None:
    async def attack() -> None:
        tried = Guesses(clock.sleep)
        for number in range(100):
            await guess(tried, f'name{number % 30}')
        assert clock.waits.count(0) == 100
        clock.waits.clear()
        for _ in range(4):
            await guess(tried, 'ben')
        await guess(tried, 'ben', known=True)
        await guess(tried, 'ben', HOME)
        assert clock.waits == [1, 2, 4, 4, 0, 0]

    asyncio.run(attack())


def test_who_waits_holds_up_nobody_else() -> None:
    async def attack() -> None:
        begun, go_on = asyncio.Event(), asyncio.Event()

        async def sleep(_: float) -> None:
            begun.set()
            await go_on.wait()

        tried = Guesses(sleep)
        attempts = [asyncio.ensure_future(guess(tried)) for _ in range(3)]
        await begun.wait()
        with pytest.raises(TooManyError):
            await guess(tried)
        # Others at the same address, she herself at home, and in the browser that she uses.
        others = [('ben', SCHOOL, False), ('anna', HOME, False), ('anna', SCHOOL, True)]
        attempts += [asyncio.ensure_future(guess(tried, *who[:2], known=who[2])) for who in others]
        go_on.set()
        await asyncio.gather(*attempts)
        await guess(tried)  # there is room again

    asyncio.run(asyncio.wait_for(attack(), 60))


def test_attempts_for_one_account_come_one_after_the_other() -> None:
    async def attack() -> None:
        tried, inside = Guesses(), []

        async def look(address: str) -> None:
            async with tried.turn('anna', address, known=False):
                inside.append('in')
                await asyncio.sleep(0)
                inside.append('out')

        await asyncio.gather(*(look(f'192.0.2.{number}') for number in range(9)))
        assert inside == ['in', 'out'] * 9

    asyncio.run(attack())


def test_names_without_end_are_not_kept(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guesses, '_KEPT', 50)

    async def attack() -> Guesses:
        tried = Guesses(clock.sleep)
        for number in range(200):
            await guess(tried, f'name{number}')
        return tried

    tried = asyncio.run(attack())
    assert len(tried._wrong) == 50 and not tried._waiting and not tried._lanes


@pytest.mark.parametrize(
    ('headers', 'address'),
    [
        ({}, HOME),
        ({'X-Forwarded-For': SCHOOL}, SCHOOL),
        ({'X-Forwarded-For': f'1.2.3.4, {SCHOOL}', 'X-Real-Ip': '1.2.3.4'}, SCHOOL),
    ],
)
def test_only_the_proxy_says_where_a_request_comes_from(
    headers: dict[str, str], address: str
) -> None:
    request = SimpleNamespace(headers=HTTPHeaders(headers), remote_ip=HOME)
    assert _address(request) == address


def test_a_flood_is_refused_and_the_owner_comes_in(tmp_path: Path) -> None:
    make_passwords(tmp_path, ['anna'])
    password = (tmp_path / FIRST_PASSWORDS).read_text().split()[1]
    keeper = ClassAuthenticator(dbm_path=str(tmp_path / HASHES), check_passwords_on_startup=False)
    cookies: dict[str, bytes] = {}

    def log_in(word: str, cookies: dict[str, bytes] | None = None) -> Coroutine[Any, Any, Any]:
        request = request_from(SCHOOL, cookies)
        return keeper.authenticate(request, {'username': 'Anna', 'password': word})

    async def attack() -> None:
        assert await log_in(password, cookies) == 'anna'
        flood = [log_in('a guess') for _ in range(9)]
        *seen, own = await asyncio.gather(
            *flood, log_in(password, cookies), return_exceptions=True
        )
        assert seen.count(None) == 3 and own == 'anna'
        assert {one.status_code for one in seen if one is not None} == {429}
        # A cookie says nothing once the password is another one.
        make_passwords(tmp_path, ['anna'], anew=['anna'])
        shown, *later = [log_in('a guess', dict(cookies)) for _ in range(5)]
        assert await shown is None
        seen = await asyncio.gather(*later, log_in('a guess'), return_exceptions=True)
        assert seen.count(None) == 3

    asyncio.run(attack())
