"""The command line: `python3 -m labkit lab`, `python3 -m labkit test`, and others."""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from labkit import __version__
from labkit.course.run_tests import run_tests
from labkit.errors import LabError, SetupError

__all__ = ['main']

# Command -> the module whose `main(argv)` runs it with all further words.
_FORWARDED = {
    'classroom': 'labkit.teaching.command',
    'progress': 'labkit.exercises.record.progress',
    'ros2': 'labkit.ros2',
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command of labkit.

    Args:
        argv: The words after `labkit`; those of the command line if None.

    Returns:
        The exit code: 2 if this machine, or the command, is not right.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        return _run(words)
    except LabError as error:
        print(f'labkit: {error}', file=sys.stderr)
        return 2
    except BrokenPipeError:  # as after `| head`, which has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print('\nlabkit: interrupted. Repeat the command to go on.', file=sys.stderr)
        return 130


def _run(words: list[str]) -> int:
    if words and words[0] in _forwarded():
        _enter_environment(words)
        module = importlib.import_module(_FORWARDED[words[0]])
        return int(module.main(words[1:]))
    options, others = _parser().parse_known_args(words)
    if others and options.command not in ('hub', 'lab', 'test'):
        _parser().error(f'{options.command} does not know {" ".join(others)!r}')
    if others[:1] == ['--']:
        others = others[1:]
    if options.command == 'lab':
        from labkit.course.jupyterlab import prepare, start_lab

        if not options.prepare:
            start_lab(others)
        prepare()
        return 0
    if options.command == 'hub':
        from labkit.hub.command import run_hub

        return run_hub(
            others,
            class_list=options.class_list,
            folder=options.folder,
            image=options.image,
            new_password=options.new_password,
            prepare=options.prepare,
        )
    if options.command == 'physics':
        from labkit.sim.physics.install_physics import install_physics

        print(install_physics())
        return 0
    if options.command == 'test':
        return run_tests(
            others, everything=options.all, fast=options.fast, coverage=options.coverage
        )
    if options.command == 'reset':
        from labkit.course.learner_folder import reset

        print(reset(options.lesson))
        return 0
    if options.command == 'restore':
        from labkit.course.copies import restore

        print('\n'.join(restore(options.notebook, options.at)))
        return 0
    if options.command == 'docs' and options.words:
        _enter_environment(words)
        from labkit.course.all_words import all_words

        print(*all_words(), sep='\n')
        return 0
    if options.command == 'docs':
        from labkit.course.public_names import write_page
        from labkit.course.site import build_site

        print(build_site(Path(options.out)) if options.site else write_page())
        return 0
    if options.command == 'doctor':
        return _doctor(words)
    _enter_environment(words)
    if options.command == 'lesson':
        from labkit.course.live_coding import write_blank, write_solved

        print((write_blank if options.blank else write_solved)(options.lesson))
        return 0
    from labkit.course.record import record

    return record(options.lessons)


def _doctor(words: Sequence[str]) -> int:
    try:
        _enter_environment(words)
    except LabError:
        pass  # no Python with ROS: the doctor reports that, among others
    from labkit.checkup.report import doctor

    report = doctor()
    print(report)
    return 0 if report.ok else 1


def _forwarded() -> list[str]:
    """Return the commands whose modules are installed."""
    folder = Path(__file__).parent.parent
    found = []
    for command, module in _FORWARDED.items():
        path = folder.joinpath(*module.split('.'))
        if path.is_dir() or path.with_suffix('.py').is_file():
            found.append(command)
    return found


def _enter_environment(words: Sequence[str]) -> None:
    """Continue in the environment's Python, unless this one is an environment with ROS."""
    from labkit.setup.environment import PYTHON, VENV, environment_variables, existing_environment

    has_ros = importlib.util.find_spec('rclpy') is not None and sys.version_info >= (3, 10)
    inside = os.path.realpath(sys.prefix) == os.path.realpath(VENV)
    if inside and not has_ros:
        raise SetupError(
            f'The environment {str(VENV)!r} is without ROS 2.',
            todo='Delete that folder, and make it anew: python3 -m labkit lab',
        )
    # Another environment with ROS is the learner's choice; packages of the system are not.
    chosen = inside or sys.prefix != sys.base_prefix or not PYTHON.exists()
    if not (has_ros and chosen):
        python = existing_environment()
        command = [str(python), '-m', 'labkit', *words]
        os.execve(python, command, environment_variables())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='labkit',
        description='Learn ROS 2 in Jupyter notebooks. Start with: python3 -m labkit lab',
        allow_abbrev=False,
    )
    parser.add_argument('--version', action='version', version=f'labkit {__version__}')
    commands = parser.add_subparsers(dest='command', metavar='command', required=True)

    def add(name: str, text: str, more: str = '') -> argparse.ArgumentParser:
        return commands.add_parser(
            name, help=text, description=f'{text}. {more}'.strip(), allow_abbrev=False
        )

    lab = add(
        'lab',
        'Make the environment if need be, and open the lessons in JupyterLab',
        'Options it does not know, and all after `--`, go to JupyterLab: '
        '`--no-browser`, `--port 9000`.',
    )
    lab.add_argument('--prepare', action='store_true', help='install what is needed, and end')
    hub = add(
        'hub',
        'Start JupyterHub for a class, on this machine',
        'Options it does not know, and all after `--`, go to JupyterHub: `--port 9000`. '
        'docs/hub.md tells more.',
    )
    hub.add_argument(
        '--class', dest='class_list', metavar='FILE', help='a text file with a name on each line'
    )
    hub.add_argument('--folder', help='what the hub keeps; /var/lib/labkit-hub if not given')
    hub.add_argument('--image', help='run servers in containers of this image of Docker')
    hub.add_argument('--new-password', metavar='NAME', help='make one for somebody, and end')
    hub.add_argument('--prepare', action='store_true', help='install what is needed, and end')
    test = add(
        'test',
        'Run every cell of every lesson, and the tests that are not slow',
        'What fails is tried once more at the end, alone, and that is told. With the number of '
        'a lesson, such as `04`, what is about that lesson. Other options, and '
        'paths, are for pytest, which then runs alone: `-k odds`, `tests/sim`.',
    )
    test.add_argument(
        '--fast', action='store_true', help='only what takes seconds: style, types, layers, format'
    )
    test.add_argument(
        '--all',
        action='store_true',
        help='slow tests and quarantined ones too; then what is quick on each other Python here',
    )
    test.add_argument(
        '--coverage', action='store_true', help='show which lines and branches of labkit ran'
    )
    add('physics', 'Install what simulated worlds with physics need')
    add('doctor', 'Say what is wrong with this machine or environment, and what to do')
    record = add('record', 'Run lessons and store their outputs in notebooks/')
    record.add_argument(
        'lessons',
        nargs='*',
        metavar='NN',
        help='numbers or names, or files in other folders; all of notebooks/ if none is given',
    )
    lesson = add(
        'lesson',
        'Write a lesson for a class into your folder',
        'Made from the published lesson each time. What is there already goes to its backups.',
    )
    lesson.add_argument('lesson', metavar='NN', help='number or name of the lesson')
    form = lesson.add_mutually_exclusive_group(required=True)
    form.add_argument(
        '--blank',
        action='store_true',
        help='headings, tasks and empty cells to type into; the rest goes to a page of notes',
    )
    form.add_argument('--solved', action='store_true', help='with solutions in their cells')
    reset = add('reset', 'Get a fresh copy of a lesson, and keep the old one as a backup')
    reset.add_argument('lesson', metavar='NN', help='number or name of the lesson')
    restore = add(
        'restore',
        'Get notebooks back that are gone or broken, as you last saved them',
        'Without a number: all that are gone, can not be read, or are as new.',
    )
    restore.add_argument(
        'notebook', nargs='?', metavar='NN', help='number or name of a lesson, as it was before'
    )
    restore.add_argument('--at', metavar='TIME', help="such as '2026-11-26 09:4'; needs NN")
    docs = add('docs', 'Write docs/api.md and docs/faults.md anew from the code')
    docs.add_argument('--words', action='store_true', help='list all that a learner can read')
    docs.add_argument('--site', action='store_true', help='build the documentation site instead')
    docs.add_argument('--out', default='site', metavar='DIR', help='its folder (%(default)s)')
    for name in _forwarded():
        text = {
            'classroom': 'Show what the learners of a class share, or write it as a table',
            'progress': 'Show what you have solved',
            'ros2': 'The words of the ros2 command',
        }
        commands.add_parser(name, help=text[name], add_help=False)
    return parser


if __name__ == '__main__':
    sys.exit(main())
