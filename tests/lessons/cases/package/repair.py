"""Answers to `repair`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'not built',
        'colcon build has not been run since',
        ('!colcon build --packages-select broken_lab\n', ''),
    ),
    wrong(
        'as it was, built',
        'Its last build has failed.',
        (
            'text = text.replace("talker:main\'", "talker:main\',")\n'
            "text = text.replace('listener:mian', 'listener:main')\n",
            '',
        ),
    ),
    wrong(
        'the comma alone',
        'The entry in setup.py names a function that the module does not have.',
        ("text = text.replace('listener:mian', 'listener:main')\n", ''),
    ),
    wrong(
        'the name alone',
        'Its last build has failed.',
        ('text = text.replace("talker:main\'", "talker:main\',")\n', ''),
    ),
    wrong(
        'without the talker',
        'executables: listener',
        (
            'text = text.replace("talker:main\'", "talker:main\',")\n',
            "text = text.replace(\"'talker = broken_lab.talker:main'\", '')\n",
        ),
    ),
    wrong(
        'without the listener',
        'executables: talker',
        (
            "text = text.replace('listener:mian', 'listener:main')\n",
            "text = text.replace(\"'listener = broken_lab.listener:mian'\", '')\n",
        ),
    ),
    wrong(
        'one for both',
        'The name of the node is what super().__init__() gets.',
        (
            "text = text.replace('listener:mian', 'listener:main')\n",
            "text = text.replace('listener:mian', 'talker:main')\n",
        ),
    ),
    wrong(
        'another module',
        'names a module that is not there',
        (
            "text = text.replace('listener:mian', 'listener:main')\n",
            "text = text.replace('listener:mian', 'listner:main')\n",
        ),
    ),
    wrong(
        'another name for ros2 run',
        'What stands before = in setup.py is the name for ros2 run.',
        (
            "text = text.replace('listener:mian', 'listener:main')\n",
            "text = text.replace('listener:mian', 'listener:main')\n"
            "text = text.replace('listener =', 'listner =')\n",
        ),
    ),
    wrong(
        'changed after the build',
        'Its last build has failed.',
        (
            'setup.write_text(text)\n!colcon build --packages-select broken_lab\n',
            '!colcon build --packages-select broken_lab\nsetup.write_text(text)\n',
        ),
    ),
    right(
        'regular expression',
        ('from labkit', 'import re\n\nfrom labkit'),
        (
            'text = text.replace("talker:main\'", "talker:main\',")\n',
            "text = re.sub(r\"(talker:main')$\", r'\\1,', text, flags=re.MULTILINE)\n",
        ),
    ),
    right(
        'the whole workspace', ('!colcon build --packages-select broken_lab\n', '!colcon build\n')
    ),
    right(
        'a list of its own',
        (
            'text = text.replace("talker:main\'", "talker:main\',")\n'
            "text = text.replace('listener:mian', 'listener:main')\n",
            "entries = [\n    'talker = broken_lab.talker:main',\n"
            "    'listener = broken_lab.listener:main',\n]\n"
            "before, _, after = text.partition('[\\n            ')\n"
            'text = f\'{before}{entries!r}{after.partition("]")[2]}\'\n',
        ),
    ),
    right(
        'the other function',
        ("text = text.replace('listener:mian', 'listener:main')\n", ''),
        (
            '!colcon build --packages-select broken_lab\n',
            "module = setup.with_name('broken_lab') / 'listener.py'\n"
            "module.write_text(module.read_text().replace('main(', 'mian('))\n"
            '!colcon build --packages-select broken_lab\n',
        ),
    ),
]
