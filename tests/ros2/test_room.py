"""What the room of the `ros2` words leans on, and who leans on it."""

from __future__ import annotations

import re
from pathlib import Path

import labkit

ROOT = Path(labkit.__file__).parent
# The magic, the command line, and the lesson about the command line; what is launched from a
# notebook is the command `ros2 launch`.
USERS = {'__init__.py', '__main__.py', 'lessons/command_line', 'launching/launched.py'}


def test_knowledge_about_ros_is_not_looked_for_among_the_words_of_a_command():
    users = {
        path.relative_to(ROOT)
        for path in ROOT.rglob('*.py')
        if path.relative_to(ROOT).parts[0] != 'ros2'
        and re.search(r'^\s*(from|import) labkit\.ros2|[\'"]labkit\.ros2', path.read_text(), re.M)
    }
    others = {str(path) for path in users if not {str(path), str(path.parent)} & USERS}
    assert others == set()
