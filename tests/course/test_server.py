"""What JupyterLab writes to the terminal: its address, and what is wrong, each once."""

from __future__ import annotations

import logging

import pytest

from labkit.course.server import Quiet

ADDRESS = 'http://127.0.0.1:8888/lab/tree/00_start_here.ipynb?token=3aa6ae1f587de5eb'


@pytest.fixture
def log() -> logging.Logger:
    """A log that shows what the filter lets pass."""
    logger = logging.Logger('ServerApp')
    logger.addFilter(Quiet())
    return logger


def test_address_is_alone_on_a_line_and_there_once(
    log: logging.Logger, capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    log.addHandler(caplog.handler)
    log.info('Jupyter Server 2.21.1 is running at:')
    log.info(ADDRESS)
    log.info(f'    {ADDRESS}')
    log.critical(f'\n    To access the server, open this file:\n  file:///x\n  {ADDRESS}')
    assert capsys.readouterr().out == f'\n    {ADDRESS}\n\n'
    assert caplog.records == []


def test_what_is_wrong_is_said_once(log: logging.Logger, caplog: pytest.LogCaptureFixture) -> None:
    log.addHandler(caplog.handler)
    for name in ('a', 'a', 'b'):
        log.warning('%s is missing', name)
        log.info('%s was loaded', name)
    log.warning('The websocket_ping_timeout (90) cannot be longer than something else')
    log.error('it ends')
    assert caplog.messages == ['a is missing', 'b is missing', 'it ends']


def test_an_error_in_a_request_is_shown_without_the_token(
    log: logging.Logger, caplog: pytest.LogCaptureFixture
) -> None:
    log.addHandler(caplog.handler)
    try:
        raise ValueError('%d is no state')
    except ValueError:
        log.exception('Uncaught exception %s', f'DELETE {ADDRESS} 100%')
    said = ADDRESS.replace('3aa6ae1f587de5eb', '...')
    assert caplog.messages == [f'Uncaught exception DELETE {said} 100%']
    assert 'ValueError' in caplog.text
