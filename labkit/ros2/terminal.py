"""`ros2` in a terminal: prefer a real one, join the domain of the running notebook, complete."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

from labkit import domain_ids, settings
from labkit.background import domains
from labkit.errors import LabError
from labkit.files import read_limited
from labkit.ros2.open_pages import notebooks_in_pages

__all__ = ['BASH', 'choose_domain', 'real_ros2', 'run']

# `complete -C` calls the command with the line so far in COMP_LINE.
BASH = "complete -o default -C 'ros2 --complete' ros2"


def run(words: list[str]) -> int:
    """Run one command.

    Args:
        words: The words after `ros2`.

    Returns:
        The exit code.
    """
    if words[:1] == ['--complete'] and 'COMP_LINE' in os.environ:
        return _complete()
    if words == ['--completion']:
        print(BASH)
        return 0
    real = real_ros2()
    if real is not None:
        sys.stdout.flush()
        os.execve(real, [str(real), *words], _environment_of_others())
    if not _asks_nobody(words):
        try:
            chosen = choose_domain()
        except LabError as error:
            print(error, file=sys.stderr)
            return 2
        if chosen:
            print(chosen, file=sys.stderr, flush=True)
    from labkit.ros2.shell import execute

    settings.is_ros2_command = True
    try:
        code = execute(words)
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        # The reader of the output has gone, as `head` does. Python flushes once more at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


def real_ros2() -> Path | None:
    """Return the `ros2` of a full installation, None if there is none on the path."""
    own = Path(sys.prefix, 'bin').resolve()
    for folder in os.environ.get('PATH', '').split(os.pathsep):
        found = shutil.which('ros2', path=folder) if folder else None
        if found and Path(found).resolve().parent != own and not _is_ours(Path(found)):
            return Path(found)
    return None


def choose_domain() -> str:
    """Join the domain of the running notebook, unless `ROS_DOMAIN_ID` says otherwise.

    Returns:
        Which one of several was taken, in a line: the one that was used last, of those that a page
        shows. '' if there was no choice.

    Raises:
        LabError: `ROS_DOMAIN_ID` is no domain.
    """
    if domain_ids.read_domain_id() is not None:
        return ''
    notebooks = domains.claimed_domains()
    if len(notebooks) < 2:
        for domain_id in notebooks:
            domain_ids.set_domain(domain_id)
        return ''
    from labkit.asking.notebook_graph import last_used

    in_pages = notebooks_in_pages()
    used = {number: last_used(number) for number in notebooks}
    # The newest kernel comes first, and so is the one of those that tell nothing.
    first, *others = sorted(
        notebooks, key=lambda number: (not in_pages.get(notebooks[number], True), -used[number])
    )
    domain_ids.set_domain(first)
    told = ', '.join(f'{number} ({notebooks[number]})' for number in others)
    why = 'used' if used[first] else 'started'
    return (
        f'Domain {first}, of the notebook {why} last: {notebooks[first]}. Others: {told}. To '
        f'choose: {domain_ids.how_to_join(others[0])}'
    )


def _asks_nobody(words: list[str]) -> bool:
    """Tell whether a command reads only files, so that any domain will do."""
    if words[:1] in ([], ['pkg'], ['interface']) or {'-h', '--help'} & {*words}:
        return True
    if words[0] == 'bag':
        return words[1:2] in ([], ['convert'], ['info'], ['list'], ['reindex'])
    if words[0] != 'launch':
        return False
    from labkit.ros2.shell import command

    try:
        args = command('launch').verbs[0].parser('launch').read(words[1:])
    except LabError:
        return True  # it will be said
    return bool(args.print_description or args.show_args)


def _complete() -> int:
    """Print completions at the cursor, for bash."""
    line = os.environ['COMP_LINE'][: int(os.environ.get('COMP_POINT', '0')) or None]
    try:
        choose_domain()
    except LabError:
        pass
    from labkit.ros2.completion import complete_line

    _, _, rest = line.partition(' ')
    last, words = complete_line(rest)
    # For bash a word starts over after a colon or an equals sign.
    kept = max(last.rfind(':'), last.rfind('=')) + 1
    print('\n'.join(word[kept:] for word in words))
    return 0


def _is_ours(path: Path) -> bool:
    """Return whether a script belongs to another environment of this course."""
    try:
        return b'labkit.ros2' in read_limited(path)[:2000]
    except OSError:
        return False


def _environment_of_others() -> dict[str, str]:
    """Return the variables without those that make the libraries of the wheels take precedence."""
    variables = dict(os.environ)
    variables.pop('_ROS_WHEELS_BOOTSTRAP_COMPLETE', None)
    paths = variables.pop('LD_LIBRARY_PATH', '').split(os.pathsep)
    others = [path for path in paths if path and not path.startswith(sys.prefix)]
    if others:
        variables['LD_LIBRARY_PATH'] = os.pathsep.join(others)
    return variables
