"""labkit as an installed package, for runs of pytest that find its plugin."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from flit_core.buildapi import prepare_metadata_for_build_editable

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope='session')
def metadata(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make what an installer writes about labkit: other checkouts share this environment."""
    folder = tmp_path_factory.mktemp('metadata')
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        prepare_metadata_for_build_editable(str(folder))
    return folder


@pytest.fixture
def installed(metadata: Path, lab_env: dict[str, str]) -> dict[str, str]:
    """Give the variables with which a process finds labkit as an installed package."""
    return {**lab_env, 'PYTHONPATH': os.pathsep.join([str(metadata), lab_env['PYTHONPATH']])}
