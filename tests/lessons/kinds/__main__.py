"""Print the table of kinds, and what is missing in it: of the lessons that are named, or all."""

from __future__ import annotations

import sys
from pathlib import Path

if __name__ == '__main__':
    sys.path[:1] = [str(path) for path in Path(__file__).resolve().parents[1:4]]
    from kinds import main

    main(sys.argv[1:])
