"""`%ros2 ...` in a notebook, with Tab completion."""

from __future__ import annotations

import re
import sys
from typing import Any

__all__ = ['register']


def register() -> None:
    """Register `%ros2` with the running IPython, if there is one. Must stay light and fast."""
    ipython = sys.modules.get('IPython')
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None:
        return
    shell.register_magic_function(_ros2, 'line', 'ros2')
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


def _ros2(line: str) -> None:
    """Run a `ros2` command: `%ros2 topic list`; `%ros2 -h` shows all of them."""
    from labkit.ros2.shell import run_line

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
    shell = sys.modules['IPython'].get_ipython()
    last, words = _possible(shell.Completer.text_until_cursor)
    # The replaced text ends at the cursor, but need not begin where the command's word does.
    start = len(last) - len(text)
    return [word[start:] if start >= 0 else text[:-start] + word for word in words]


def _possible(text: str) -> tuple[str, list[str]]:
    """Return the word before the cursor and its completions; nothing on other lines."""
    magic, space, line = text.lstrip().partition(' ')
    if magic != '%ros2' or not space:
        return '', []
    from labkit.ros2.completion import complete_line

    last, words = complete_line(line)
    return last, list(words)
