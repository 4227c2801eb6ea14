"""Answers to `repair`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

COMMA, NAME = "s/teller:main'/teller:main',/", 's/hearer:mian/hearer:main/'
BUILD = 'colcon build --packages-select broken_lab\n'
TALK = 'ros2 run broken_lab teller > teller.log 2>&1 &\n'
LISTEN = 'ros2 run broken_lab hearer > hearer.log 2>&1 &\n'

ANSWERS = [
    wrong('not built', 'colcon build has not been run since', (BUILD, '')),
    wrong('as it was, built', 'Its last build has failed.', (f'{COMMA}; {NAME}', '')),
    wrong(
        'the comma alone',
        'If it ends at once, read there why.',
        (f'; {NAME}', ''),
    ),
    wrong('the name alone', 'Its last build has failed.', (f'{COMMA}; ', '')),
    wrong(
        'the name in install alone',
        'Files in install are made by the build.',
        (f'; {NAME}', ''),
        (
            BUILD,
            BUILD
            + "find install/broken_lab -name entry_points.txt -exec sed -i 's/mian/main/' {} +\n",
        ),
    ),
    wrong('without the teller', 'executables: hearer', (COMMA, '/teller:main/d')),
    wrong('without the hearer', 'executables: teller', (NAME, '/hearer:mian/d')),
    wrong(
        'one for both',
        'A node of that name is there, of another program.',
        (NAME, 's/hearer:mian/teller:main/'),
        (TALK, ''),
        (LISTEN, f'{LISTEN}until ros2 node list | grep -q teller; do :; done\n'),
    ),
    wrong(
        'another module',
        'If it ends at once, read there why.',
        (NAME, 's/hearer:mian/listner:main/'),
    ),
    wrong(
        'another name for ros2 run',
        'What stands before = in setup.py is the name for ros2 run.',
        (NAME, f'{NAME}; s/hearer =/herer =/'),
    ),
    wrong(
        'changed after the build',
        'Its last build has failed.',
        (BUILD, ''),
        ('cd ros2_ws\n', f'cd ros2_ws\n{BUILD}'),
    ),
    wrong(
        'the hearer makes the teller',
        'hearer makes a node of this name, too.',
        (NAME, 's/hearer:mian/teller:main/'),
        (LISTEN, f'{LISTEN}until [ $(ros2 node list | grep -c teller) = 2 ]; do :; done\n'),
    ),
    wrong(
        'in a namespace',
        'The name is right, and it lies in a namespace: /x/teller.',
        (TALK, TALK.replace(' >', ' --ros-args -r __ns:=/x >')),
    ),
    wrong('one terminal', '/hearer on the graph', (LISTEN, '')),
    right('the whole workspace', (BUILD, 'colcon build\n')),
    right('links instead of copies', (BUILD, BUILD.replace('\n', ' --symlink-install\n'))),
    right(
        'the other function',
        (f'; {NAME}', ''),
        (BUILD, f"sed -i 's/main(/mian(/' src/broken_lab/broken_lab/hearer.py\n{BUILD}"),
    ),
    right('from the notebook'),
]
