"""Answers to `manifest`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

BUILD = '!colcon build --packages-select courier_lab\n'
NAMES = "['rclpy', 'std_msgs', 'geometry_msgs']"
WRITE = "xml.write_text(xml.read_text().replace(lines[0], ''.join(lines)))\n"

ANSWERS = [
    wrong('not built', 'colcon build has not been run since', (BUILD, '')),
    wrong('as it was, built', 'without std_msgs and geometry_msgs', (NAMES, "['rclpy']")),
    wrong('texts alone', 'Seen: without geometry_msgs', (", 'geometry_msgs'", '')),
    wrong('points alone', 'Seen: without std_msgs', (", 'std_msgs'", '')),
    wrong(
        'a letter is missing',
        'On another machine rosdep installs what package.xml names',
        ("'std_msgs'", "'std_msg'"),
    ),
    wrong('the class for the package', 'without geometry_msgs', ("'geometry_msgs'", "'Point'")),
    wrong(
        'for tests alone',
        'Seen: without std_msgs and geometry_msgs',
        (
            WRITE,
            "more = ''.join(lines[1:]).replace('depend', 'test_depend')\n"
            'xml.write_text(xml.read_text().replace(lines[0], lines[0] + more))\n',
        ),
    ),
    wrong(
        'a module of Python, too',
        'Python brings this module itself',
        ("'geometry_msgs']", "'geometry_msgs', 'math']"),
    ),
    wrong(
        'named after the build',
        'files in src that are newer than the last build that went well',
        (WRITE + BUILD, BUILD + WRITE),
    ),
    wrong(
        'behind the end of the file',
        'rosdep can not read what the package needs',
        (WRITE, "xml.write_text(xml.read_text() + ''.join(lines[1:]))\n"),
    ),
    wrong(
        'an import is taken out',
        'does not import geometry_msgs any more',
        (", 'geometry_msgs'", ''),
        (
            BUILD,
            "code = xml.parent / 'courier_lab/courier.py'\n"
            "code.write_text(code.read_text().replace('geometry_msgs.msg', 'nowhere'))\n" + BUILD,
        ),
    ),
    wrong(
        'the code is empty',
        'The entry in setup.py names a function that the module does not have.',
        (BUILD, "(xml.parent / 'courier_lab/courier.py').write_text('')\n" + BUILD),
    ),
    right('the whole workspace', (BUILD, '!colcon build\n')),
    right(
        'for running alone', ("''.join(lines)", "''.join(lines).replace('depend', 'exec_depend')")
    ),
    right('one more than is imported', ("'geometry_msgs']", "'geometry_msgs', 'nav_msgs']")),
    right(
        'by sed',
        (
            "names = ['rclpy', 'std_msgs', 'geometry_msgs']\n"
            "lines = [f'  <depend>{name}</depend>\\n' for name in names]\n" + WRITE,
            "!sed -i 's#<depend>rclpy#<depend>std_msgs</depend><depend>geometry_msgs</depend>&#' "
            '{xml}\n',
        ),
    ),
]
