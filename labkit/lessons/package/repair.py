"""Exercise: a package whose build fails, and then one of its programs."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, NotAttempted, Probe, Solution, Style, Wrong, changed
from labkit.exercises.exercise import NOTHING_YET
from labkit.lessons.package.content import Built, Runs, judge_package
from labkit.lessons.package.made import BROKEN
from labkit.lessons.package.workspace import workspace

__all__ = ['repair']

_REPAIR = """
from labkit.lessons.package.made import make_broken

setup = make_broken()
text = setup.read_text()
text = text.replace("talker:main'", "talker:main',")
text = text.replace('listener:mian', 'listener:main')
setup.write_text(text)
!colcon build --packages-select broken_lab
"""
_COMMA = """text = text.replace("talker:main'", "talker:main',")\n"""
_NAME = "text = text.replace('listener:mian', 'listener:main')\n"
_BUILD = '!colcon build --packages-select broken_lab\n'

CLAUSES: Sequence[Built | Runs] = [
    Built(BROKEN),
    Runs('talker', 'talker', BROKEN),
    Runs('listener', 'listener', BROKEN),
]


def _judge(probe: Probe) -> str:
    folder = workspace()
    setup = folder / 'src' / BROKEN / 'setup.py' if folder else None
    if folder and setup and setup.is_file() and not (folder / 'build' / BROKEN).is_dir():
        text = setup.read_text(encoding='utf-8', errors='replace')
        if "talker:main'\n" in text and 'listener:mian' in text:
            raise NotAttempted(NOTHING_YET)  # as the lesson has made it
    return judge_package(probe, CLAUSES, BROKEN)


repair = Exercise(
    name='repair',
    task='Repair the package broken_lab, build it, and let both of its programs run.',
    clauses=CLAUSES,
    judge=_judge,
    hints=[
        'Build it, and look at the lines under stderr. What is Python not content with?',
        'Two pieces of text without a comma between them become one piece.',
        'The first fault is a comma that is missing after the talker. The second one: a function '
        'main is called mian.',
    ],
    answer=Solution(
        _REPAIR,
        'Without the comma Python makes one entry of the two. The wrong name of a function is '
        'found only when the program runs.',
    ),
    styles=[
        Style(
            'regular expression',
            changed(
                _REPAIR,
                ('from labkit', 'import re\n\nfrom labkit'),
                (
                    _COMMA,
                    """text = re.sub(r"(talker:main')$", r'\\1,', text, flags=re.MULTILINE)\n""",
                ),
            ),
        ),
        Style('the whole workspace', changed(_REPAIR, (_BUILD, '!colcon build\n'))),
        Style(
            'a list of its own',
            changed(
                _REPAIR,
                (
                    _COMMA + _NAME,
                    'entries = [\n'
                    "    'talker = broken_lab.talker:main',\n"
                    "    'listener = broken_lab.listener:main',\n"
                    ']\n'
                    "before, _, after = text.partition('[\\n            ')\n"
                    'text = f\'{before}{entries!r}{after.partition("]")[2]}\'\n',
                ),
            ),
        ),
        Style(
            'the other function',
            changed(
                _REPAIR,
                (_NAME, ''),
                (
                    _BUILD,
                    "module = setup.with_name('broken_lab') / 'listener.py'\n"
                    "module.write_text(module.read_text().replace('main(', 'mian('))\n" + _BUILD,
                ),
            ),
        ),
    ],
    wrong=[
        Wrong('not built', changed(_REPAIR, (_BUILD, '')), 'colcon build has not been run since'),
        Wrong(
            'as it was, built',
            changed(_REPAIR, (_COMMA + _NAME, '')),
            'colcon build has not been run since, or it has failed',
        ),
        Wrong(
            'the comma alone',
            changed(_REPAIR, (_NAME, '')),
            'The entry in setup.py names a function that the module does not have.',
        ),
        Wrong(
            'the name alone',
            changed(_REPAIR, (_COMMA, '')),
            'colcon build has not been run since, or it has failed',
        ),
        Wrong(
            'without the talker',
            changed(
                _REPAIR,
                (_COMMA, """text = text.replace("'talker = broken_lab.talker:main'", '')\n"""),
            ),
            'executables: listener',
        ),
        Wrong(
            'without the listener',
            changed(
                _REPAIR,
                (_NAME, """text = text.replace("'listener = broken_lab.listener:mian'", '')\n"""),
            ),
            'executables: talker',
        ),
        Wrong(
            'one for both',
            changed(_REPAIR, (_NAME, "text = text.replace('listener:mian', 'talker:main')\n")),
            'The name of the node is what super().__init__() gets.',
        ),
        Wrong(
            'another module',
            changed(_REPAIR, (_NAME, "text = text.replace('listener:mian', 'listner:main')\n")),
            'names a module that is not there',
        ),
        Wrong(
            'another name for ros2 run',
            changed(_REPAIR, (_NAME, _NAME + "text = text.replace('listener =', 'listner =')\n")),
            'What stands before = in setup.py is the name for ros2 run.',
        ),
        Wrong(
            'changed after the build',
            changed(
                _REPAIR, ('setup.write_text(text)\n' + _BUILD, _BUILD + 'setup.write_text(text)\n')
            ),
            'colcon build has not been run since, or it has failed',
        ),
    ],
)
