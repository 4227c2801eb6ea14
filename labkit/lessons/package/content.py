"""What a task asks of a package, clause by clause: its files, its build, and what it runs."""

from __future__ import annotations

import os
import re
import subprocess
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from labkit import stop_button
from labkit.errors import nearest
from labkit.exercises import (
    Clause,
    Fail,
    Mistake,
    NotAttempted,
    Probe,
    Stage,
    common_mistakes,
    words_of,
)
from labkit.exercises.clauses import Asked
from labkit.exercises.expect.timing import FOUND_SEC
from labkit.exercises.figures import many
from labkit.exercises.machine_faults import refuse_machine_fault
from labkit.exercises.messages_heard import Lived
from labkit.exercises.observation import Life, live
from labkit.lessons._terminal import APPEAR_SEC
from labkit.lessons.package.learner_workspace import workspace

if TYPE_CHECKING:
    from labkit.programs.child_processes import Process
    from labkit.rosgraph.endpoints import Endpoint

__all__ = [
    'TESTED',
    'Built',
    'InAWorkspace',
    'Runs',
    'Work',
    'dependencies',
    'own_files',
    'refuse_program',
]

WORDS = words_of(__file__)

# How long a node is watched that keeps a time of its own, s of real time.
WATCH_SEC = 8.0
# The packages of the lesson, some of which have names that are close to each other.
PACKAGES = ('beacon_lab', 'broken_lab', 'counter_lab', 'ears_lab', 'odds_lab', 'robot_basics_lab')
_SOURCES = ('.py', '.xml', '.cfg')
_NOT_YET = 'Not attempted yet. {} Do what the task says, then run this cell again.'

NO_PACKAGE = WORDS.mistake('package/none')
BESIDE_SRC = WORDS.mistake('package/beside-src')
OTHER_NAME = WORDS.mistake('package/other-name')
NOT_BUILT = WORDS.mistake('package/not-built')
FAILED_BUILD = WORDS.mistake('package/failed-build')
OLD_BUILD = WORDS.mistake('package/old-build')
CHANGED_BUILD = WORDS.mistake('package/changed-build')
NO_TEST_SINCE = WORDS.mistake('package/no-test-since')
TEST_FAILED = WORDS.mistake('package/test-failed')
NO_TEST = WORDS.mistake('package/no-test')
NEW_ENTRY = WORDS.mistake('package/new-entry')
OTHER_ENTRY = WORDS.mistake('package/other-entry')
NO_ENTRY = WORDS.mistake('package/no-entry')
RUNS_ALREADY = WORDS.mistake('package/runs-already')
NO_FUNCTION = WORDS.mistake('package/no-function')
NO_MODULE = WORDS.mistake('package/no-module')
RETURNED = WORDS.mistake('package/returned')
RAISED = WORDS.mistake('package/raised')
NOT_XML = WORDS.mistake('package/not-xml')
NODE_NAME = WORDS.mistake('package/node-name')
NO_NODE = WORDS.mistake('package/no-node')


@dataclass
class Work:
    """A package that is looked at.

    Attributes:
        probe: The probe of the check.
        package: Its name.
        folder: The workspace.
        running: What was started of it last, and runs.
        ran: The names of all executables that were started.
        lives: What was seen of its nodes, by their full names.
    """

    probe: Probe
    package: str
    folder: Path
    running: Process | None = None
    ran: list[str] = field(default_factory=list)
    lives: dict[str, Life] = field(default_factory=dict)

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
        found = self.program('')
        return sorted(path.name for path in found.glob('*')) if found.is_dir() else []

    @property
    def changed(self) -> float:
        """Return when its source was changed last, s since 1970."""
        return max(_written(path) for path in self.source.rglob('*') if _is_source(path))

    def program(self, name: str) -> Path:
        """Return the path of what `ros2 run` starts."""
        return self.folder / 'install' / self.package / 'lib' / self.package / name

    def sourced(self) -> dict[str, str]:
        """Return the variables of a terminal that has sourced the workspace."""
        from labkit.programs.child_processes import environment

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
        """Wait until something is true; tell whether it is."""
        return self.probe.wait(condition, FOUND_SEC)

    def start(self, program: str) -> Process:
        """Start one of its executables, as `ros2 run` does, after the end of the one before."""
        from labkit.programs.child_processes import start_process
        from labkit.rosgraph.snapshot import node_names

        self.stop()  # it may have a node of the same name
        before = node_names(self.probe.spun_node)
        process = start_process(
            f'{self.package} {program}', [str(self.program(program))], self.sourced()
        )
        self.running, self.ran = process, [*self.ran, program]
        process.wait_for_nodes(self.probe.spun_node, before, APPEAR_SEC)
        return process

    def life(self, node: str, topics: Mapping[str, str], step: float) -> Life:
        """Let half a minute pass for a node of it, and return what it said, once for all clauses.

        One that keeps a time of its own is watched for some seconds.

        Args:
            node: Its full name.
            topics: What is listened to, with the types.
            step: How often it is told the time, s. A timer is called once in it at most.
        """
        if node not in self.lives:
            life = live(self.probe, topics, nodes=[node], step=step)
            self.lives[node] = life if life.remote else self._watched(topics)
        return self.lives[node]

    def _watched(self, topics: Mapping[str, str]) -> Life:
        watches = {topic: self.probe.watch(topic, name) for topic, name in topics.items()}
        began = time.time()
        self.probe.wait(lambda: False, WATCH_SEC)
        life = Life(time.time() - began)
        for topic, watch in watches.items():
            life.samples[topic] = [
                Lived(each.message, each.stamp, each.number, each.stamp - began)
                for each in watch.samples
            ]
        return life

    def stop(self) -> None:
        """End what is running of it."""
        process, self.running = self.running, None
        if process is not None:
            process.stop()

    def end(self, node: str, topic: str, msg_type: str, kind: str = 'publisher') -> Endpoint:
        """Return a node's publisher on a topic, or its subscription to it.

        Raises:
            Fail: There is none, or it has another type.
        """
        publishes = kind == 'publisher'
        ends = self.probe.all_publishers if publishes else self.probe.all_subscriptions
        # The graph may know the node, and not yet all of its ends.
        self.wait(lambda: any(end.node == node and end.topic == topic for end in ends()))
        own = {end.topic: end for end in ends() if end.node == node}
        package, _, name = msg_type.replace('/msg/', '/').partition('/')
        told = {'kind': kind, 'topic': topic, 'msg_type': name, 'package': package}
        if topic not in own:
            does = 'publishes on' if publishes else 'subscribes to'
            near = nearest(topic, list(own))
            raise Fail(
                f'a {kind} of {node} on {topic}',
                f'it {does}: {", ".join(sorted(own)) or "no topic"}',
                (common_mistakes.STRANGE_TOPIC if near else common_mistakes.NOT_MADE).of(**told),
            )
        if own[topic].msg_type != msg_type:
            raise Fail(
                f'messages of type {msg_type} on {topic}',
                f'messages of type {own[topic].msg_type}',
                common_mistakes.OTHER_TYPE.of(**told),
            )
        return own[topic]


@dataclass(frozen=True)
class Built(Clause[Work]):
    """A package lies in the workspace, and is built as it is now."""

    package: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(package=self.package).clause('built')

    def judge(self, work: Work) -> str:
        """Raise if it is not there, or not built."""
        from labkit.rosgraph.workspaces import build_result

        if not (work.source / 'package.xml').is_file():
            _refuse_misplaced(work)
            # Classes that wait in cells are no traces here: the lesson itself has some.
            raise NotAttempted(_NOT_YET.format(f'There is no {self.package} in ros2_ws/src.'))
        wanted = f'the package {self.package}, built'
        share = work.folder / 'install' / self.package / 'share' / self.package
        if not (share / 'package.xml').is_file():
            result = build_result(work.folder, self.package)
            raise Fail(
                wanted,
                f'no package in install/{self.package}',
                NOT_BUILT if result in ('', '0') else FAILED_BUILD,
            )
        if _ended(work.build / 'colcon_build.rc') < work.changed:
            raise Fail(
                wanted,
                'files in src that are newer than the last build that went well',
                OLD_BUILD,
            )
        # That is the last file which a build writes.
        built = _written(work.build / 'colcon_build.rc')
        for path in share.parents[1].rglob('*'):
            if '__pycache__' in path.parts or not path.is_file() or _written(path) <= built:
                continue
            raise Fail(
                wanted,
                f'{path.relative_to(work.folder)} was changed after the build',
                CHANGED_BUILD.of(package=self.package),
            )
        return ''


@dataclass(frozen=True)
class Runs(Clause[Work]):
    """An executable of the package runs a node."""

    program: str
    node: str
    package: str

    @property
    def text(self) -> str:
        """What is asked for."""
        told = WORDS.of(package=self.package, program=self.program, node=self.node)
        return told.clause('runs')

    def judge(self, work: Work) -> str:
        """Start it, and raise Fail unless its node comes."""
        from labkit.asking.service_calls import wait_until_spun
        from labkit.rosgraph.snapshot import node_names

        wanted = f'the node /{self.node}, after: ros2 run {self.package} {self.program}'
        if self.program not in work.programs:
            refuse_program(self.program, work)
        if f'/{self.node}' in node_names(work.probe.node):
            raise Fail(
                f'no node of the name /{self.node} before the check starts one',
                f'/{self.node} is running already',
                RUNS_ALREADY,
            )
        process = work.start(self.program)
        if f'/{self.node}' in process.nodes:
            # One that does not answer may be about to end: nothing spins it.
            if wait_until_spun(work.probe.spun_node, f'/{self.node}'):
                return ''
            if not work.wait(lambda: not process.running):
                return ''
        if not process.running:
            refuse_machine_fault(process.output, process.exit_code)
            last = process.output[-1] if process.output else 'nothing'
            raise Fail(
                wanted,
                f'it ended with exit code {process.exit_code}, and said at last: {last}',
                _why_ended(last, process.exit_code),
            )
        raise Fail(
            wanted,
            ', '.join(process.nodes) or 'it runs, and no node has come',
            NODE_NAME.of(node=self.node) if process.nodes else NO_NODE,
        )


def _tested(work: Work) -> None:
    """Raise Fail if there is no result, or a bad one."""
    wanted = 'at least one test, and none that has failed'
    result = work.build / 'pytest.xml'
    if not result.is_file() or _written(result) < _written(work.build / 'colcon_build.rc'):
        raise Fail(
            wanted,
            'no result of a test since the last build',
            NO_TEST_SINCE.of(package=work.package),
        )
    suites = list(ET.parse(result).getroot().iter('testsuite'))
    failures, errors, skipped, tests = (
        sum(int(suite.get(key) or 0) for suite in suites)
        for key in ('failures', 'errors', 'skipped', 'tests')
    )
    if failures or errors:
        seen = f'{many(failures, "failure")} and {many(errors, "error")} in {many(tests, "test")}'
        raise Fail(wanted, seen, TEST_FAILED)
    if tests == skipped:
        raise Fail(wanted, 'no test that has run', NO_TEST)


TESTED = Asked(WORDS.clause('tested'), _tested)


@dataclass(frozen=True)
class InAWorkspace(Stage[Work]):
    """A package in the learner's workspace.

    Attributes:
        package: Its name.
        is_untouched: Whether its source is still as the lesson has made it.
    """

    package: str
    is_untouched: Callable[[Work], bool] = lambda work: False

    @contextmanager
    def scenes(self, probe: Probe, clauses: Sequence[Clause[Work]]) -> Iterator[Sequence[Work]]:
        """Give the package, and end what was started of it."""
        folder = workspace()
        if folder is None:
            raise NotAttempted(_NOT_YET.format('There is no folder ros2_ws/src.'))
        work = Work(probe, self.package, folder)
        if self.is_untouched(work):
            raise NotAttempted(_NOT_YET.format(f'{self.package} is as it was made.'))
        _refuse_without_package(work, clauses)
        try:
            yield [work]
        finally:
            with stop_button.undoing():
                work.stop()

    def tell(self, seen: Sequence[Work]) -> str:
        """Say what was started, and what was seen for a moment only."""
        said = f'{self.package} is built, and runs: {" and ".join(seen[0].ran)}.'
        for node, life in seen[0].lives.items():
            if not life.remote:
                said += (
                    f' {node} keeps a time of its own, so the check has watched it for '
                    f'{life.seconds:.1f} s. What it does later was not seen.'
                )
        return said


def dependencies(work: Work) -> list[str]:
    """Return what package.xml names for building and running: the names of packages.

    Raises:
        Fail: It is not XML. colcon builds the package all the same, by its setup.py.
    """
    try:
        root = ET.parse(work.source / 'package.xml').getroot()
    except ET.ParseError as error:
        raise Fail('a package.xml that is XML', str(error), NOT_XML) from None
    tags = ('depend', 'exec_depend', 'build_depend')
    return [(each.text or '').strip() for tag in tags for each in root.findall(tag)]


def _refuse_without_package(work: Work, clauses: Sequence[Clause[Work]]) -> None:
    """Raise Fail if a node runs in the notebook, and nothing was made of it."""
    nodes = {f'/{clause.node}' for clause in clauses if isinstance(clause, Runs)}
    here = sorted(nodes & {*work.probe.node_names()})
    if here and not work.source.exists():
        raise Fail(
            f'the package {work.package} in src',
            f'{here[0]} runs in this notebook, and there is no package',
            NO_PACKAGE.of(package=work.package),
        )


def _refuse_misplaced(work: Work) -> None:
    """Raise Fail if a package lies elsewhere, or has a name that is close."""
    found = [path.parent for path in work.folder.glob('**/package.xml') if _is_in_source(path)]
    for path in found:
        if path.name != work.package and path.name in PACKAGES:
            continue
        same = path.name == work.package
        if same or nearest(work.package, [path.name]):
            raise Fail(
                f'the package {work.package} in src',
                f'a package in {path.relative_to(work.folder)}',
                (BESIDE_SRC if same else OTHER_NAME).of(package=work.package),
            )


def _is_in_source(path: Path) -> bool:
    return not {'build', 'install', 'log'} & {*path.parts}


def refuse_program(program: str, work: Work) -> NoReturn:
    """Say why an executable is not there."""
    names = work.programs
    near = nearest(program, names)
    setup = (work.source / 'setup.py').read_text(encoding='utf-8', errors='replace')
    mistake = OTHER_ENTRY.of(near=near) if near else NO_ENTRY
    if re.search(rf"'{program}\s*=", setup) and near != program:
        mistake = NEW_ENTRY
    raise Fail(
        f'the executable {program} in the package {work.package}',
        f'executables: {", ".join(names)}' if names else 'no executable at all',
        mistake.of(program=program, package=work.package),
    )


def _why_ended(last: str, code: int | None) -> Mistake:
    if 'has no attribute' in last:
        return NO_FUNCTION
    if last.startswith('ModuleNotFoundError'):
        return NO_MODULE
    return RETURNED if code == 0 else RAISED


def own_files(folder: Path) -> list[Path]:
    """Return the files in a folder that no program leaves there by itself."""
    return [
        path
        for path in sorted(folder.rglob('*'))
        if path.is_file() and not any(map(_is_left, path.relative_to(folder).parts))
    ]


def _is_left(name: str) -> bool:
    return name.startswith('.') or name == '__pycache__' or name.endswith(('~', '.egg-info'))


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
