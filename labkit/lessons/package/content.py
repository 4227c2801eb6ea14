"""What a task asks of a package, clause by clause: its files, its build, and what it runs."""

from __future__ import annotations

import os
import re
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from labkit.errors import nearest
from labkit.exercises import Fail, NotAttempted, Probe
from labkit.exercises.clauses import Clause
from labkit.exercises.clauses.base import naming
from labkit.exercises.exercise import NOTHING_YET
from labkit.lessons.package.workspace import workspace

if TYPE_CHECKING:
    from labkit.background.child_processes import Process

__all__ = ['Built', 'Does', 'Runs', 'Tested', 'Work', 'judge_package']

APPEAR_SEC = 15.0
ANSWER_SEC = 2.0
# So long it is waited for messages that come several times a second, on a machine at rest.
WAIT_SEC = 3.0
# The packages of the lesson, some of which have names that are close to each other.
PACKAGES = ('beacon_lab', 'broken_lab', 'counter_lab', 'ears_lab', 'odds_lab', 'robot_basics_lab')
_SOURCES = ('.py', '.xml', '.cfg')


@dataclass
class Work:
    """A package that is looked at.

    Attributes:
        probe: The probe of the check.
        package: Its name.
        folder: The workspace.
        running: What was started of it last, and runs.
        ran: The names of all executables that were started.
    """

    probe: Probe
    package: str
    folder: Path
    running: Process | None = None
    ran: list[str] = field(default_factory=list)

    @property
    def source(self) -> Path:
        """Return the folder of its source."""
        return self.folder / 'src' / self.package

    @property
    def build(self) -> Path:
        """Return the folder in which colcon has built it."""
        return self.folder / 'build' / self.package

    @property
    def programs(self) -> list[str]:
        """Return what `ros2 run` can start of it."""
        found = self.folder / 'install' / self.package / 'lib' / self.package
        return sorted(path.name for path in found.glob('*')) if found.is_dir() else []

    def sourced(self) -> dict[str, str]:
        """Return the variables of a terminal that has sourced the workspace."""
        from labkit.background.child_processes import environment

        said = subprocess.run(
            ['bash', '-c', '. install/setup.bash && env -0'],
            cwd=self.folder,
            env=environment(),
            capture_output=True,
            check=False,
        )
        pairs = [each.partition('=') for each in os.fsdecode(said.stdout).split('\0')]
        return {name: value for name, _, value in pairs if name}

    def wait(self, condition: Callable[[], object]) -> bool:
        """Wait until something is true, longer where the machine is busy; tell whether it is."""
        from labkit.background.patience import busyness

        return self.probe.wait(condition, WAIT_SEC * busyness())

    def start(self, program: str) -> Process:
        """Start one of its executables, as `ros2 run` does, after the end of the one before."""
        from labkit.background.child_processes import start_process
        from labkit.rosgraph.snapshot import node_names

        path = self.folder / 'install' / self.package / 'lib' / self.package / program
        self.stop()  # it may have a node of the same name
        before = node_names(self.probe.spun_node)
        process = start_process(f'{self.package} {program}', [str(path)], self.sourced())
        self.running, self.ran = process, [*self.ran, program]
        process.wait_for_nodes(self.probe.spun_node, before, APPEAR_SEC)
        return process

    def stop(self) -> None:
        """End what is running of it."""
        process, self.running = self.running, None
        if process is not None:
            process.stop()


@dataclass(frozen=True)
class Built(Clause):
    """A package lies in the workspace, and is built as it is now."""

    package: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'the package `{self.package}` lies in `src`, and is built as it is now'

    def look(self, work: Work) -> None:
        """Raise if it is not there, or not built."""
        if not (work.source / 'package.xml').is_file():
            _refuse_misplaced(work)
            # Classes that wait in cells are no traces here: the lesson itself has some.
            raise NotAttempted(NOTHING_YET)
        wanted = f'the package {self.package}, built'
        share = work.folder / 'install' / self.package / 'share' / self.package
        if not (share / 'package.xml').is_file():
            raise Fail(
                wanted,
                f'no install/{self.package}',
                why='colcon build has not been run since, or it has failed.',
                todo='Run !colcon build in the workspace, and read what it says under stderr.',
            )
        changed = max(_written(path) for path in work.source.rglob('*') if _is_source(path))
        if _ended(work.build / 'colcon_build.rc') < changed:
            raise Fail(
                wanted,
                'files in src that are newer than the last build that went well',
                why='What is changed in src is not in install before the next build has gone '
                'well.',
                todo='Run !colcon build once more, and read what it says.',
            )


@dataclass(frozen=True)
class Runs(Clause):
    """An executable of the package runs a node."""

    program: str
    node: str
    package: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'`ros2 run {self.package} {self.program}` runs a node of the name `{self.node}`'

    def look(self, work: Work) -> None:
        """Start it, and raise Fail unless its node comes."""
        from labkit.background.service_calls import wait_until_spun
        from labkit.rosgraph.snapshot import node_names

        wanted = f'the node /{self.node}, after: ros2 run {self.package} {self.program}'
        if self.program not in work.programs:
            _refuse_program(self.program, work)
        if f'/{self.node}' in node_names(work.probe.node):
            raise Fail(
                f'no node of the name /{self.node} before the check starts one',
                f'/{self.node} is running already',
                todo='End it: lab.processes().stop(), and lab.remove for a node of a cell.',
            )
        process = work.start(self.program)
        if f'/{self.node}' in process.nodes:
            # One that does not answer may be about to end: nothing spins it.
            if wait_until_spun(work.probe.spun_node, f'/{self.node}', ANSWER_SEC):
                return
            if not work.wait(lambda: not process.running):
                return
        if not process.running:
            last = process.output[-1] if process.output else 'nothing'
            raise Fail(
                wanted,
                f'it ended with exit code {process.exit_code}, and said at last: {last}',
                why=_why_ended(last, process.exit_code),
                todo='Correct the file in src, build again, and check again.',
            )
        seen = ', '.join(process.nodes) or 'it runs, and no node has come'
        raise Fail(
            wanted,
            seen,
            why='The name of the node is what super().__init__() gets.'
            if process.nodes
            else 'main() does not make a node, or waits before that.',
            todo=f"super().__init__('{self.node}')",
        )


@dataclass(frozen=True)
class Tested(Clause):
    """`colcon test` has run, and its tests pass."""

    package: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return '`colcon test` has run after the build, at least one test, and none has failed'

    def look(self, work: Work) -> None:
        """Raise Fail if there is no result, or a bad one."""
        wanted = 'at least one test, and none that has failed'
        result = work.build / 'pytest.xml'
        if not result.is_file() or _written(result) < _written(work.build / 'colcon_build.rc'):
            raise Fail(
                wanted,
                'no result of a test since the last build',
                why='colcon build does not run tests.',
                todo=f'!colcon test --packages-select {self.package}',
            )
        suites = list(ET.parse(result).getroot().iter('testsuite'))
        count = {key: sum(int(s.get(key) or 0) for s in suites) for key in _COUNTS}
        if count['failures'] or count['errors']:
            raise Fail(
                wanted,
                f'{count["failures"]} failures and {count["errors"]} errors in '
                f'{count["tests"]} tests',
                why='A test says that something is not as it should be.',
                todo='!colcon test-result --verbose shows which one, and why.',
            )
        if count['tests'] == count['skipped']:
            raise Fail(
                wanted,
                'no test that has run',
                why='Tests are the functions test_... in the files test_... of the folder test.',
                todo='Write one: a function test_... with an assert, in test/test_....py',
            )


_COUNTS = ('tests', 'failures', 'errors', 'skipped')


@dataclass(frozen=True)
class Does(Clause):
    """What else is asked of the package.

    Attributes:
        words: What is asked for, in words of the task.
        look: Raises Fail if it is otherwise.
    """

    words: str
    look: Callable[[Work], None]

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words


def judge_package(
    probe: Probe, clauses: Sequence[Built | Runs | Tested | Does], package: str
) -> str:
    """Look at a package, clause by clause, and end what was started of it.

    Returns:
        What was seen, in a sentence.

    Raises:
        NotAttempted: It is not there.
        Fail: A clause is not fulfilled; the exception names it.
    """
    folder = workspace()
    if folder is None:
        raise NotAttempted(NOTHING_YET)
    with _ending(Work(probe, package, folder)) as work:
        _refuse_without_package(work, clauses)
        for clause in clauses:
            with naming(clause):
                clause.look(work)
    return f'{package} is built, and runs: {" and ".join(work.ran)}.'


@contextmanager
def _ending(work: Work) -> Iterator[Work]:
    try:
        yield work
    finally:
        work.stop()


def _refuse_without_package(work: Work, clauses: Sequence[Clause]) -> None:
    """Raise Fail if a node runs in the notebook, and nothing was made of it."""
    nodes = {f'/{clause.node}' for clause in clauses if isinstance(clause, Runs)}
    here = sorted(nodes & {*work.probe.node_names()})
    if here and not work.source.exists():
        raise Fail(
            f'the package {work.package} in src',
            f'{here[0]} runs in this notebook, and there is no package',
            why='A node of a notebook ends with the notebook.',
            todo=f"lab.export(..., package='{work.package}', folder='src', overwrite=True)",
        )


def _refuse_misplaced(work: Work) -> None:
    """Raise Fail if a package lies elsewhere, or has a name that is close."""
    found = [path.parent for path in work.folder.glob('**/package.xml') if _is_in_source(path)]
    for path in found:
        if path.name != work.package and path.name in PACKAGES:
            continue
        place = path.relative_to(work.folder)
        same, close = path.name == work.package, nearest(work.package, [path.name])
        if same or close:
            raise Fail(
                f'the package {work.package} in src',
                f'a package in {place}',
                why='Packages lie in the folder src of a workspace.'
                if same
                else 'The name is close, and it is another one.',
                todo=f'ros2 pkg create {work.package} --destination-directory src, or '
                "lab.export(..., folder='src')",
            )


def _is_in_source(path: Path) -> bool:
    return not {'build', 'install', 'log'} & {*path.parts}


def _refuse_program(program: str, work: Work) -> NoReturn:
    """Say why an executable is not there."""
    wanted = f'the executable {program} in the package {work.package}'
    names = work.programs
    near = nearest(program, names)
    setup = (work.source / 'setup.py').read_text(encoding='utf-8', errors='replace')
    if re.search(rf"'{program}\s*=", setup) and near != program:
        why = 'It stands in setup.py, but was not there when the package was built.'
    elif near:
        why = f'{near} is close. What stands before = in setup.py is the name for ros2 run.'
    else:
        why = 'A module alone can not be run: setup.py needs an entry for it.'
    raise Fail(
        wanted,
        f'executables: {", ".join(names)}' if names else 'no executable at all',
        why=why,
        todo=f"In console_scripts: '{program} = {work.package}.MODULE:main', then build again.",
    )


def _why_ended(last: str, code: int | None) -> str:
    if 'has no attribute' in last:
        return 'The entry in setup.py names a function that the module does not have.'
    if last.startswith('ModuleNotFoundError'):
        return 'The entry in setup.py, or an import, names a module that is not there.'
    if code == 0:
        return 'main() returned at once: nothing in it spins the node.'
    return 'The program has raised. The last line says what.'


def _is_source(path: Path) -> bool:
    return path.suffix in _SOURCES and '__pycache__' not in path.parts


def _ended(path: Path) -> float:
    """Return when a build ended, 0 if it did not end well; colcon keeps its exit code."""
    try:
        return _written(path) if path.read_text().strip() == '0' else 0.0
    except OSError:
        return 0.0


def _written(path: Path) -> float:
    """Return when a file was written, 0 if it is not there."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
