"""Run a lesson unattended, for `labkit record` and for nbval.

Both use the same `LessonRun`, so stored and compared outputs come from kernels with the same
setup, and pass through the same `normalised`.
"""

# nbformat has no annotations.
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import base64
import contextlib
import math
import os
import re
import signal
import struct
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any, cast

import nbformat
from jupyter_client.kernelspec import KernelSpecManager, NoSuchKernel
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbformat import NotebookNode
from nbval.plugin import find_comment_markers, find_metadata_tags

from labkit.errors import LabError

__all__ = ['LessonError', 'LessonRun', 'has_what_it_needs', 'nbval_options', 'normalised']

# A cell takes at most 5 s; the rest is for busy machines. A cell that builds sets a limit in its
# metadata: "labkit": {"timeout_sec": 1200}.
CELL_TIMEOUT_SEC = 60
OUTPUT_TIMEOUT_SEC = 30
STARTUP_TIMEOUT_SEC = 120
_TIMED_OUT = 'CellTimeoutError'
# Variables of the caller that would show in the outputs, or let others be heard.
_FOREIGN = (
    *('CLICOLOR', 'FASTDDS_', 'FASTRTPS_', 'FORCE_COLOR', 'JPY_', 'LABKIT_', 'MPLBACKEND'),
    *('NO_COLOR', 'PYTEST_', 'PYTHONDONTWRITEBYTECODE', 'PYTHONWARNINGS', 'PYTHON_COLORS'),
    *('RCUTILS_', 'RMW_', 'ROS_', 'SETUPTOOLS_'),
)
# Durations printed by colcon: 'Finished <<< my_package [1.23s]', '1 package finished [1min 2s]'.
_COLCON_TIME = r'(<<< \S+ |packages? finished )\[(?:\d+(?:h|min) )*\d+(?:\.\d+)?s(?=[],])'
_WIDGET_VIEW = 'application/vnd.jupyter.widget-view+json'


class LessonError(LabError):
    """Report that a cell of a lesson did not run as expected.

    Args:
        message: What happened.
        cell_id: The cell, `''` if none.
        traceback: The learner's view of it, in colour, `''` if there is none.
    """

    def __init__(self, message: str, *, cell_id: str = '', traceback: str = '') -> None:
        super().__init__(message)
        self.cell_id = cell_id
        self.traceback = traceback


def nbval_options(cell: NotebookNode) -> dict[str, bool]:
    """Return what nbval's tags and comments say of a cell: `skip`, `check`, `check_exception`."""
    if cell.cell_type != 'code':
        return {}
    return {**dict(find_metadata_tags(cell.metadata)), **dict(find_comment_markers(cell.source))}


def has_what_it_needs(cell: NotebookNode) -> bool:
    """Tell whether the module is here that a cell needs by its metadata: "needs": "mujoco".

    Without it the cell runs, too, and says so. It is compared, and recorded, only with it.
    """
    return find_spec(cell.metadata.get('labkit', {}).get('needs', 'labkit')) is not None


class LessonRun:
    """Run the cells of one lesson in a new kernel.

    The kernel starts in the lesson's folder, with a new state folder (`LABKIT_HOME`) and with ROS
    discovery off. A lesson with the metadata `"labkit": {"processes": true}` finds other processes
    on this machine (LOCALHOST), in its own domain. A cell that nbval skips is not run here either,
    and keeps its outputs.

    Args:
        path: The notebook.
        cell_timeout_sec: Seconds per cell.
        startup_timeout_sec: Seconds for the start of the kernel.
        kernel_name: The kernel, by the name of its specification. `'python3'` is this Python.

    Attributes:
        broken: The kernel is lost.
        timed_out: A cell has taken too long, and was interrupted.
        shown: What the cell that ran last has shown, before it was normalised.

    Raises:
        LessonError: The kernel did not start.
    """

    def __init__(
        self,
        path: Path,
        *,
        cell_timeout_sec: float = CELL_TIMEOUT_SEC,
        startup_timeout_sec: float = STARTUP_TIMEOUT_SEC,
        kernel_name: str = 'python3',
    ) -> None:
        self.path = path.resolve()
        self.notebook: NotebookNode = nbformat.read(self.path, as_version=4)
        self.broken = False
        self.timed_out = False
        self.shown: list[NotebookNode] = []
        self._cell_timeout_sec = cell_timeout_sec
        self._next = 0
        for cell in self.notebook.cells:
            if cell.cell_type == 'code' and not nbval_options(cell).get('skip'):
                cell.outputs, cell.execution_count = [], None
        with contextlib.ExitStack() as stack:
            temporary = tempfile.TemporaryDirectory(prefix='labkit-', ignore_cleanup_errors=True)
            self._home = Path(stack.enter_context(temporary)).resolve()
            log = stack.enter_context((self._home / 'kernel.log').open('wb'))
            # Without folders to search for kernels, 'python3' is this Python. Sockets instead of
            # ports: those may be taken before the kernel has them.
            dirs: dict[str, Any] = {'kernel_dirs': []} if kernel_name == 'python3' else {}
            kernels = AsyncKernelManager(
                kernel_name=kernel_name,
                kernel_spec_manager=KernelSpecManager(**dirs),
                transport='ipc',
                ip=str(self._home / 'socket'),
            )
            stack.callback(_end_children, kernels)
            self._client = self._make_client(kernels, startup_timeout_sec)
            start = self._client.setup_kernel(
                cleanup_kc=True,
                cwd=str(self.path.parent),
                env=self._environment(),
                stdout=log,
                stderr=log,
            )
            try:
                stack.enter_context(start)
            except RuntimeError as error:
                raise LessonError(f'the kernel did not start: {error}\n{self._log()}') from error
            except NoSuchKernel:
                raise LessonError(
                    f'expected the name of a kernel, but it is {kernel_name!r}. `jupyter '
                    'kernelspec list` names them; --nbval-current-env takes the Python of pytest'
                ) from None
            self._stack = stack.pop_all()

    def _make_client(
        self, kernels: AsyncKernelManager, startup_timeout_sec: float
    ) -> NotebookClient:
        return NotebookClient(
            self.notebook,
            km=kernels,
            timeout_func=self._time_limit,
            # The traceback of the interruption says where it hung.
            interrupt_on_timeout=True,
            error_on_timeout={'ename': _TIMED_OUT},
            on_cell_executed=self._note_timeout,
            iopub_timeout=OUTPUT_TIMEOUT_SEC,
            raise_on_iopub_timeout=True,
            startup_timeout=math.ceil(startup_timeout_sec),
            # Errors are handled here: nbclient's way may make the kernel drop the next cell.
            allow_errors=True,
            skip_cells_with_tag='',  # nbval has its own
            record_timing=False,
            store_widget_state=False,
            # Output of C code arrives at any time, so it goes to the log.
            extra_arguments=['--IPKernelApp.capture_fd_output=False'],
        )

    def _environment(self) -> dict[str, str]:
        processes = self.notebook.metadata.get('labkit', {}).get('processes', False)
        # Another thread may take a variable away meanwhile, as pytest does after each test.
        names = [name for name in list(os.environ) if not name.startswith(_FOREIGN)]
        env = {name: os.environ.get(name, '') for name in names}
        return env | {
            'COLUMNS': '80',
            'IPYTHONDIR': str(self._home / 'ipython'),
            'JPY_SESSION_NAME': str(self.path),
            'LINES': '24',
            'LABKIT_HEADLESS': '1',
            'LABKIT_HOME': str(self._home / 'labkit'),
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST' if processes else 'OFF',
            'ROS_LOG_DIR': str(self._home / 'ros_log'),
            'TMPDIR': str(self._home),
        }

    def _log(self) -> str:
        """Return the last lines of the kernel's process, which say why it ended."""
        lines = (self._home / 'kernel.log').read_text(errors='replace').splitlines()
        return '\n'.join([line for line in lines if not line.startswith('[IPKernelApp]')][-20:])

    def execute(self, index: int) -> NotebookNode:
        """Run one cell, after those before it that have not run yet.

        Args:
            index: Position of the cell in the notebook, 0 for the first.

        Returns:
            The cell with its execution count and normalised outputs.

        Raises:
            LessonError: A cell raised, and is not marked as one that does. Or it took too long, or
                ended the kernel: then the run is `broken`, and every further cell fails at once.
        """
        for position in range(min(self._next, index), index + 1):
            self._execute(position)
        cell: NotebookNode = self.notebook.cells[index]
        return cell

    def _execute(self, index: int) -> None:
        cells = self.notebook.cells
        cell, cell_id = cells[index], str(cells[index].get('id', index))
        count = sum(cell.cell_type == 'code' for cell in cells[: index + 1])
        if self.broken:
            raise LessonError('not run: an earlier cell lost the kernel', cell_id=cell_id)
        self._next = max(self._next, index + 1)
        options = nbval_options(cell)
        if options.get('skip'):
            return
        self._late = False
        # As in JupyterLab: labkit asks which cell has made a node.
        assert self._client.kc is not None
        self._client.kc.session.metadata = {'cellId': cell_id}
        try:
            self._client.execute_cell(cell, index, execution_count=count)
        except (RuntimeError, TimeoutError) as error:
            self.broken = True
            # nbclient goes on to quote the cell, which is shown anyway.
            message = str(error).partition('\nHere is a preview')[0]
            raise LessonError(f'{message}\n{self._log()}'.strip(), cell_id=cell_id) from error
        if cell.cell_type == 'code':
            self.shown = cell.outputs
            cell.outputs = normalised(self.shown, self.folders())
            raised = next((out for out in cell.outputs if out.output_type == 'error'), None)
            traceback = '\n'.join(raised.traceback) if raised else ''
            if self._late:
                raise LessonError(
                    f'it took longer than {self._time_limit(cell):g} s and was interrupted',
                    cell_id=cell_id,
                    traceback=traceback,
                )
            if raised and not options.get('check_exception'):
                message = f'it raised {raised.ename}: {raised.evalue}'
                raise LessonError(message, cell_id=cell_id, traceback=traceback)

    def execute_source(self, source: str, **_: object) -> None:
        """Run code that is in no cell of the notebook."""
        cells = self.notebook.cells
        cells.append(nbformat.v4.new_code_cell(source))
        try:
            self._client.execute_cell(cells[-1], len(cells) - 1)
        finally:
            cells.pop()

    def _time_limit(self, cell: NotebookNode) -> float:
        """Return the time limit of a cell, s."""
        own = cell.metadata.get('labkit', {}).get('timeout_sec', self._cell_timeout_sec)
        return float(own)

    def _note_timeout(self, execute_reply: dict[str, Any], **_: object) -> None:
        self._late = execute_reply['content'].get('ename') == _TIMED_OUT
        self.timed_out |= self._late

    def folders(self) -> dict[str, str]:
        """Return the folders that differ between machines, and their placeholders."""
        known = {
            str(self._home): '$TMPDIR',
            sys.prefix: '$ENVIRONMENT',
            sys.base_prefix: '$PYTHON',
            str(self.path.parent.parent): '$COURSE',
        }
        return {folder: name for folder, name in known.items() if folder not in ('/', '/usr')}

    def close(self) -> None:
        """End the kernel and its children, and remove its temporary files."""
        self._stack.close()

    def __enter__(self) -> LessonRun:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _end_children(kernels: AsyncKernelManager) -> None:
    """Kill the process group of a kernel that has ended."""
    group = getattr(kernels.provisioner, 'pgid', None)
    if group is not None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(group, signal.SIGKILL)


def normalised(outputs: list[NotebookNode], folders: dict[str, str]) -> list[NotebookNode]:
    """Return outputs in the form in which they are stored and compared.

    Parts of a stream are joined; folders that differ between machines, and the times that colcon
    prints, are replaced; the views of live widgets are dropped.

    Args:
        outputs: Outputs of one cell.
        folders: Absolute folder -> its placeholder.
    """
    result: list[NotebookNode] = []
    for output in outputs:
        output = cast(NotebookNode, _without_folders(output, folders))
        data = output.get('data', {})
        data.pop(_WIDGET_VIEW, None)
        if 'image/png' in data:
            data['image/png'] = _without_metadata(data['image/png'])
        if output.output_type == 'stream':
            _add_stream(result, output)
        else:
            result.append(output)
    return result


def _add_stream(result: list[NotebookNode], output: NotebookNode) -> None:
    """Append to the output of the same stream since the last picture, result or error.

    The two streams reach a notebook separately, in random order: standard output is put first.
    """
    start = len(result)
    while start > 0 and result[start - 1].output_type == 'stream':
        start -= 1
    for earlier in result[start:]:
        if earlier.name == output.name:
            earlier.text += output.text
            return
    result.insert(start if output.name == 'stdout' else len(result), output)


def _without_folders(value: Any, folders: dict[str, str]) -> Any:
    """Return a copy of an output, or a part of it, without folders and times of this machine."""
    if isinstance(value, dict):
        return NotebookNode({k: _without_folders(v, folders) for k, v in value.items()})
    if isinstance(value, list):
        return [_without_folders(item, folders) for item in value]
    if not isinstance(value, str):
        return value
    # A warning names the temporary file of a cell, with the process id. Checked first: the pattern
    # is slow on long texts without spaces, such as pictures.
    if '/ipykernel_' in value:
        value = re.sub(r'[^\s"\']*/ipykernel_\d+/\d+\.py', 'cell', value)
    if '<<< ' in value or ' finished [' in value:
        value = re.sub(_COLCON_TIME, r'\1[... s', value)
    home = str(Path.home())
    for folder in sorted(folders, key=len, reverse=True):
        # IPython abbreviates the home folder as `~` in tracebacks.
        short = '~' + folder.removeprefix(home) if folder.startswith(f'{home}/') else folder
        for form in (folder, short):
            # A whole path: it may follow a colour code, but not another part of a path.
            pattern = rf'(^|\x1b\[[\d;]*m|[^\w/.-]){re.escape(form)}(?![\w-])'
            value = re.sub(pattern, rf'\g<1>{folders[folder]}', value, flags=re.MULTILINE)
    return value


def _without_metadata(text: str) -> str:
    """Return a PNG, in base64, without metadata about programs, versions and times."""
    png = base64.b64decode(text)
    kept, start = [png[:8]], 8
    while start < len(png):
        # Length of the data, type, data, checksum (PNG specification, section 5.3).
        length, kind = struct.unpack('>I4s', png[start : start + 8])
        end = start + 12 + length
        if kind not in (b'tEXt', b'zTXt', b'iTXt', b'tIME', b'eXIf'):
            kept.append(png[start:end])
        start = end
    return base64.b64encode(b''.join(kept)).decode()
