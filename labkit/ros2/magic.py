"""`%ros2 ...` and `%%ros2` in a notebook, on one line or several, with Tab completion."""

from __future__ import annotations

import re
import sys
from typing import Any

from labkit import settings

__all__ = ['register']

# A command, where a statement begins. What it becomes is what IPython makes of a line of its own.
_COMMAND = re.compile(r'([ \t]*)(?:(%ros2)[ \t]+|!(?=ros2[ \t]))(?=\S)')


def register() -> None:
    """Register `%ros2` with the running IPython, if there is one. Must stay light and fast."""
    shell = settings.shell()
    if shell is None:
        return
    shell.register_magic_function(_ros2, 'line_cell', 'ros2')
    if _join_lines not in shell.input_transformers_cleanup:
        shell.input_transformers_cleanup.append(_join_lines)
    matchers = shell.Completer.custom_matchers
    if _complete in matchers or _complete_word in matchers:
        return
    try:
        from IPython.core.completer import context_matcher
    except ImportError:  # before IPython 8.6, as in Google Colab
        matchers.append(_complete_word)
    else:
        context_matcher()(_complete)
        matchers.append(_complete)


def _ros2(line: str, cell: str = '') -> None:
    """Run a `ros2` command: `%ros2 topic list`; `%ros2 -h` shows all of them.

    After `%%ros2`, at the beginning of a cell, all of the cell is one command.
    """
    from labkit.ros2.shell import run_line

    line = f'{line}\n{cell}'.rstrip('\n')
    several = _is_one_of_several()
    if several:
        # As in a terminal: otherwise nobody could tell which output belongs to which command.
        print(f'$ ros2 {line}', flush=True)
    run_line(line)
    if several:
        sys.stdout.flush()
        sys.stderr.flush()  # or the next command's output would overtake an error


def _is_one_of_several() -> bool:
    """Return whether the running cell has more such lines."""
    from labkit import settings

    if not settings.in_kernel():
        return False
    from labkit.background.compat import running_request

    code = running_request().get('content', {}).get('code', '')
    return len(re.findall(r'^[ \t]*%ros2[ \t]', code, re.MULTILINE)) > 1


# Braces and dollar signs belong to YAML; IPython would expand them as Python variables.
_ros2._ipython_magic_no_var_expand = True  # type: ignore[attr-defined]


def _join_lines(lines: list[str]) -> list[str]:
    """Make one line of a command whose quotation mark closes on a later line.

    IPython calls it with each cell, before it looks for magics and before Python looks at the
    indentation, which in YAML follows other rules. The number of lines stays.
    """
    if not any(map(_COMMAND.match, lines)) or lines[0].startswith('%%'):
        return lines
    done: list[str] = []
    rest = list(lines)
    while rest:
        start, count = _COMMAND.match(rest[0]), 1
        if start:
            count = _count_lines([rest[0][start.end() :], *rest[1:]])
        if start and count > 1 and _is_statement(done, start[1]):
            text = ''.join(rest[:count])[start.end() :].rstrip('\n')
            call = f"run_line_magic('ros2', {text!r})" if start[2] else f'system({text!r})'
            done += [f'{start[1]}get_ipython().{call}\n', *['\n'] * (count - 1)]
        else:
            count = 1
            done.append(rest[0])
        del rest[:count]
    return done


def _count_lines(lines: list[str]) -> int:
    """Return how many lines a command takes: all, if a quotation mark never closes."""
    from labkit.ros2.shell import is_complete

    ends = (n for n in range(1, len(lines)) if is_complete(''.join(lines[:n])))
    return next(ends, len(lines))


def _is_statement(before: list[str], indent: str) -> bool:
    """Return whether a statement may begin after these lines: not inside a string or brackets."""
    from IPython.core.inputtransformer2 import TransformerManager

    probe = f'{indent}%ros2\n'
    manager: Any = TransformerManager()  # type: ignore[no-untyped-call]
    try:
        return bool(manager.do_token_transforms([*before, probe])[-1] != probe)
    except SyntaxError:
        return False  # Python says what is wrong with it


def _complete(context: Any) -> dict[str, Any]:
    """Return completions at the cursor; called by IPython's completer for every line."""
    from IPython.core.completer import SimpleCompletion

    last, words = _possible(context.text_until_cursor)
    if not words:
        return {'completions': []}
    return {
        'completions': [SimpleCompletion(text=word, type='ros2') for word in words],
        'matched_fragment': last,
        'ordered': True,
        'suppress': True,  # no Python completions here
    }


def _complete_word(text: str) -> list[str]:
    """Return completions for `text` at the cursor, for an older IPython."""
    shell = settings.shell()
    last, words = _possible(shell.Completer.text_until_cursor)
    # The replaced text ends at the cursor, but need not begin where the command's word does.
    start = len(last) - len(text)
    return [word[start:] if start >= 0 else text[:-start] + word for word in words]


def _possible(text: str) -> tuple[str, list[str]]:
    """Return the word before the cursor and its completions; nothing on other lines."""
    magic, space, line = text.lstrip().partition(' ')
    if magic not in ('%ros2', '%%ros2') or not space:
        return '', []
    from labkit.ros2.completion import complete_line

    last, words = complete_line(line)
    return last, list(words)
