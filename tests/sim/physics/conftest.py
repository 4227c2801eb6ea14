"""Tests of the world with physics: MuJoCo has wheels for Python 3.11 and newer."""

from __future__ import annotations

import sys

collect_ignore_glob = ['test_*.py'] if sys.version_info < (3, 11) else []
