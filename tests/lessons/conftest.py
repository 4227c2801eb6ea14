"""What the tests of the lessons share: the harness beside this file."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
# With pytest's importlib mode a test can't import the file beside it by itself.
sys.path.insert(0, str(HERE))
# Neither a test nor, for nbval, a lesson.
collect_ignore = ['demo']
