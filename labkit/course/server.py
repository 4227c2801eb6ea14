"""JupyterLab in this process, with a quiet log: its address, and what is wrong, each once.

The kernel of the notebook on which it opens starts with it, not when the page asks for one: while
JupyterLab is loaded, which takes longer, it gets ready.

It is run by its path and imports nothing of labkit: what labkit sets for ROS is for kernels, not
for the terminals that JupyterLab starts.
"""

from __future__ import annotations

import logging
import re
import sys
from collections.abc import Sequence

__all__ = ['Quiet', 'main']

_ADDRESS = re.compile(r'\s*(https?://\S+)\s*')
# What tornado puts right by itself at each connection, and what is so with each fresh lesson.
_NO_MATTER = re.compile(r'The websocket_ping_timeout|Notebook .* is not trusted')
_LOGGERS = (
    *('ServerApp', 'LabApp', 'LabServerApp', 'ExtensionApp'),
    *('tornado.access', 'tornado.application', 'tornado.general'),
)


class Quiet(logging.Filter):
    """Let warnings and errors pass, each of them once, and print the address alone on a line."""

    def __init__(self) -> None:
        super().__init__()
        self._passed: set[str] = set()
        self._told = False

    def filter(self, record: logging.LogRecord) -> bool:
        """Tell whether a line of the log is to be shown."""
        text = record.getMessage()
        address = _ADDRESS.fullmatch(text)
        if address and not self._told:
            self._told = True
            print(f'\n    {address[1]}\n', flush=True)
        # The address comes once more, with what to do about it.
        known = 'token=' in text or text in self._passed
        if known or _NO_MATTER.match(text) or record.levelno < logging.WARNING:
            return False
        self._passed.add(text)
        return True


def main(arguments: Sequence[str]) -> None:
    """Run JupyterLab to its end.

    Args:
        arguments: Its options. With `--debug`, or a level of the log, nothing is held back.
    """
    from jupyterlab.labapp import LabApp

    # Its options and its log are called by this name.
    class ServerApp(LabApp.serverapp_class):  # type: ignore[misc]
        def start_app(self) -> None:
            super().start_app()
            self.io_loop.add_callback(self._start_kernel)

        async def _start_kernel(self) -> None:
            path = self.default_url.partition('/lab/tree/')[2]
            if path.endswith('.ipynb'):
                # The page takes the kernel that its notebook has. What fails here, it says.
                await self.session_manager.create_session(
                    path=path, name=path.rpartition('/')[2], type='notebook'
                )

    LabApp.serverapp_class = ServerApp
    if not any(re.match(r'--debug$|--(\w+\.)?log[-_]level', word) for word in arguments):
        quiet = Quiet()
        for name in _LOGGERS:
            logging.getLogger(name).addFilter(quiet)
    LabApp.launch_instance(list(arguments))


if __name__ == '__main__':
    main(sys.argv[1:])
