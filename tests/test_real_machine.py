"""The boxes "On a real machine": each of their terminals is whole, and all are in one domain."""

from __future__ import annotations

import re
import shlex
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import nbformat
import pytest

NOTEBOOKS = Path(__file__).resolve().parent.parent / 'notebooks'
PATHS = sorted(NOTEBOOKS.glob('*.ipynb'))
# What a machine with ROS has: the first ones need a terminal that has sourced ROS.
OF_ROS = ('python3', 'ros2', 'rqt_graph', 'rviz2')
OTHERS = ('colcon', 'git', 'rosdep', 'sudo')
# Stands in for each: it writes down what it was called with, and where.
STAND_IN = """#!/bin/bash
printf '%s\\x1f' "${ROS_DISTRO-}" "${ROS_DOMAIN_ID-}" "${0##*/}" "$@" >> "$RECORD"
echo >> "$RECORD"
[ "${0##*/}" != python3 ] || [ -f "$1" ] || { echo "there is no file $1" >&2; exit 2; }
[ "${0##*/} ${1-}" != 'git clone' ] || mkdir -p "$3"
"""
# The first is there on such a machine, the second one is made by `colcon build`.
SOURCE = """source() {
  case "$1" in
    /opt/ros/jazzy/setup.bash) export ROS_DISTRO=jazzy;;
    install/setup.bash) ;;
    *) echo "there is no file $1" >&2; return 2;;
  esac
}
"""


@dataclass(frozen=True)
class Ran:
    """A program that a terminal has started, and what the terminal had set by then."""

    distribution: str
    domain: str
    words: Sequence[str]


def cells_of(path: Path) -> list[nbformat.NotebookNode]:
    return nbformat.read(path, as_version=4).cells


def blocks_of(path: Path) -> list[str]:
    """Return the terminals of a lesson's box, as they are printed."""
    box = next(cell.source for cell in cells_of(path) if cell.id == 'real-machine')
    return re.findall(r'```bash\n(.*?)```', box, flags=re.S)


def files_of(path: Path) -> list[str]:
    """Return the files that a lesson makes: in a cell, or in an editor, as a task asks."""
    sources = [cell.source for cell in cells_of(path)]
    pattern = r"^(?:%%writefile |Path\('|cat > )([\w/]+\.py)(?:'\)\.write_text| <<|$)"
    written = [re.findall(pattern, source, flags=re.M) for source in sources]
    asked = [re.findall(r'^- .*`python3 (\S+\.py)', source, flags=re.M) for source in sources]
    return [name for names in (*written, *asked) for name in names]


def typed(block: str, home: Path) -> list[Ran]:
    """Type a block into a bash of its own; return what it has started."""
    programs, record = home / 'bin', home / 'record'
    programs.mkdir(exist_ok=True)
    for name in (*OF_ROS, *OTHERS):
        (programs / name).write_text(STAND_IN)
        (programs / name).chmod(0o755)
    record.write_text('')
    done = subprocess.run(
        ['/bin/bash', '-ec', SOURCE + block],
        cwd=home,
        env={'PATH': f'{programs}:/usr/bin:/bin', 'HOME': str(home), 'RECORD': str(record)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = [line.split('\x1f')[:-1] for line in record.read_text().splitlines()]
    return [Ran(distribution, domain, words) for distribution, domain, *words in lines]


def commands(block: str, home: Path) -> Iterator[list[str]]:
    """Yield the programs that a reader of a block expects to be started, with their arguments."""
    for line in block.replace('\\\n', '').replace('~/', f'{home}/').splitlines():
        words = shlex.split(line, comments=True)
        for is_and, group in groupby(words, '&&'.__eq__):
            command = [word for word in group if not re.match(r'[A-Z_]+=', word)]
            if not is_and and command and command[0] in (*OF_ROS, *OTHERS):
                yield command


def judge(blocks: Sequence[str], home: Path) -> None:
    """Refuse a box whose terminals do not do what they say, or do not hear each other."""
    (home / '.ros/log').mkdir(parents=True)
    assert len(blocks) >= 2, 'one terminal alone hears nobody'
    domains = set()
    for number, block in enumerate(blocks, start=1):
        assert block.startswith(f'# Terminal {number}\n'), f'{block!r} has no number'
        ran = typed(block, home)
        assert [list(each.words) for each in ran] == list(commands(block, home))
        ros = [each for each in ran if each.words[0] in OF_ROS]
        assert ros, f'terminal {number} runs nothing of ROS'
        assert {each.distribution for each in ros} == {'jazzy'}, f'{number} is not sourced'
        domains |= {each.domain for each in ros}
    assert domains == {'7'}, f'the terminals are in the domains {sorted(domains)}'


@pytest.mark.parametrize('path', PATHS, ids=lambda path: path.stem)
def test_each_terminal_is_whole_and_all_are_in_one_domain(path: Path, tmp_path: Path) -> None:
    for name in files_of(path):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    judge(blocks_of(path), tmp_path)


GOOD = [
    '# Terminal 1\nsource /opt/ros/jazzy/setup.bash\nexport ROS_DOMAIN_ID=7  # in all\n'
    'ros2 run demo_nodes_py talker  # until Ctrl-C\n',
    '# Terminal 2\nsource /opt/ros/jazzy/setup.bash\nexport ROS_DOMAIN_ID=7\n'
    'ros2 topic pub --once /chatter std_msgs/msg/String "{data: \'Hi: you\'}"\n',
]


def test_a_good_box_passes(tmp_path: Path) -> None:
    judge(GOOD, tmp_path)


@pytest.mark.parametrize(
    ('old', 'new', 'says'),
    [
        ('source /opt/ros/jazzy/setup.bash\nexport ROS_DOMAIN_ID=7\n', '', 'not sourced'),
        ('export ROS_DOMAIN_ID=7\n', '', r"domains \['', '7'\]"),
        ('ROS_DOMAIN_ID=7\n', 'ROS_DOMAIN_ID=8\n', r"domains \['7', '8'\]"),
        ('/opt/ros/jazzy', '/opt/ros/humble', 'there is no file /opt/ros/humble'),
        ('ros2 topic', 'python3 talker.py', 'there is no file talker.py'),
        ('ros2 topic', '# ros2 topic', 'nothing of ROS'),
        ('# Terminal 2', '# In a second terminal', 'has no number'),
    ],
)
def test_a_terminal_that_is_not_whole_is_found(
    old: str, new: str, says: str, tmp_path: Path
) -> None:
    with pytest.raises(AssertionError, match=says):
        judge([GOOD[0], GOOD[1].replace(old, new)], tmp_path)


def test_all_in_one_block_is_found(tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match='hears nobody'):
        judge([''.join(GOOD)], tmp_path)
