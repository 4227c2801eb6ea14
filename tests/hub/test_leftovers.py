"""What learners leave in their `/tmp` never stops a hub, and nothing goes through a link."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest

from labkit.hub.accounts import make_private_folder
from labkit.hub.leftovers import ASIDE

# In the folder that it was started in, whatever that is called by now.
_WRITER = 'n=0; echo go; while :; do n=$((n + 1)); mkdir -p "d$n"; : > "d$n/file"; done'


def test_what_is_left_is_removed_however_deep(tmp_path: Path) -> None:
    private = tmp_path / 'private'
    outside = tmp_path / 'outside'
    outside.mkdir()
    (outside / 'thesis.txt').write_text('years of work')
    make_private_folder(private, ['anna'])
    deep = private / 'ben-tmp'
    deep.mkdir()
    subprocess.run(['mkdir', '-p', 'd/' * 1_500], cwd=deep, check=True)
    (deep / 'link').symlink_to(outside)
    (private / 'carl-tmp').symlink_to(outside)
    (private / 'dora').write_text('a file')
    (private / 'anna-tmp').mkdir()
    left = make_private_folder(private, ['anna'])
    assert {path.name for path in private.iterdir()} == {'anna-tmp', ASIDE}
    while left:  # on a busy machine the next removal goes on with it
        left = make_private_folder(private, ['anna'])
    assert list((private / ASIDE).iterdir()) == []
    assert (outside / 'thesis.txt').read_text() == 'years of work'


def test_a_program_that_goes_on_writing_stops_nothing(tmp_path: Path) -> None:
    place = tmp_path / 'ben-tmp'
    place.mkdir()
    with subprocess.Popen(['sh', '-c', _WRITER], cwd=place, stdout=subprocess.PIPE) as writer:
        assert writer.stdout is not None and writer.stdout.readline()
        try:
            said = make_private_folder(tmp_path, ['anna'])
            assert not place.exists()
            assert said == '' or ASIDE in said
        finally:
            os.kill(writer.pid, signal.SIGKILL)


def test_what_resists_is_told_and_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    private, programs = tmp_path / 'private', tmp_path / 'bin'
    programs.mkdir()
    (programs / 'rm').write_text('#!/bin/sh\nexit 1\n')
    (programs / 'rm').chmod(0o755)
    make_private_folder(private, [])
    (private / 'ben-tmp').mkdir()
    with monkeypatch.context() as patch:
        patch.setenv('PATH', str(programs))
        assert '1 could not be removed' in make_private_folder(private, [])
    assert (private / ASIDE).stat().st_mode & 0o777 == 0o700
    (private / 'carl-tmp').mkdir()
    assert make_private_folder(private, []) == ''
    assert list((private / ASIDE).iterdir()) == []
