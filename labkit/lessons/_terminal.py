"""A program that the learner runs in a terminal: its process, and its node on the graph.

The learner writes it in an editor, so nothing of it is in the notebook. A check finds it as it
finds any process: by its command line, and by the id of the process in the ids of its node.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from labkit import domain_ids
from labkit.errors import nearest
from labkit.exercises import Fail, Mistake, NotAttempted, words_of
from labkit.exercises.clauses import Evidence, GraphClause
from labkit.exercises.expect.timing import FOUND_SEC
from labkit.exercises.what_is_asked import NODE, Role

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['APPEAR_SEC', 'AT_WORK_SEC', 'InATerminal', 'RunsFile']

# How long a node may take to appear on a busy machine, s.
APPEAR_SEC = 15.0
# A program on its way to a node runs, or waits for a processor or a disk, but for moments: in this
# time there are a hundred looks, s.
AT_WORK_SEC = 1.0
# In so many seconds a new client finds a node also on a busy machine.
ANSWER_SEC = 4.0
# What an editor makes, and may have made in the place of a file of Python.
_TEXTS = ('.py', '.txt')
# The start of a process is known to a second.
_OFF_SEC = 1.5

WORDS = words_of(__file__)

NOT_RUNNING = WORDS.mistake('terminal/not-running')
OTHER_DOMAIN = WORDS.mistake('terminal/other-domain')
NOT_FOUND = WORDS.mistake('terminal/not-found')
OTHER_PROGRAM = WORDS.mistake('terminal/other-program')
TWICE = WORDS.mistake('terminal/twice')
OLD_RUN = WORDS.mistake('terminal/old-run')
NOT_SPUN = WORDS.mistake('terminal/not-spun')
BY_ANOTHER = WORDS.mistake('terminal/twice-by-another')
IN_A_NAMESPACE = WORDS.mistake('terminal/in-a-namespace')
NODE_NAME = WORDS.mistake('terminal/node-name')
REMAPPED = WORDS.mistake('terminal/node-name-remapped')
ONE_FOR_ALL = WORDS.mistake('terminal/one-for-all')
NO_FILE = WORDS.mistake('terminal/no-file')
MISPLACED = WORDS.mistake('terminal/misplaced')


@dataclass(frozen=True)
class InATerminal:
    """A program in a terminal whose node is looked for.

    Attributes:
        node: Full name of the node.
        command: What is typed.
        start: A sentence that says what to type, and where.
        again: A sentence that says what to do after a correction.
        source: What it is made of: `'src'`, or a file.
        is_mine: Tells whether a process, one of psutil, is the program or about to become it.
        changed: Returns when the source was changed last, s since 1970.
        joins: Whether the command joins the notebook by itself, as `ros2` does.
        has_to_answer: Whether its node has to be spun. One that only publishes need not.
    """

    node: str
    command: str
    start: str
    again: str
    source: str
    is_mine: Callable[[Any], bool]
    changed: Callable[[], float]
    joins: bool = False
    has_to_answer: bool = False

    def find(self, probe: Probe) -> Any:
        """Return its process, as psutil has it; wait for its node.

        A node that answers is complete: all that it publishes and subscribes to is known then.

        Raises:
            Fail: It is not there, not started from what is there now, or has to answer and does
                not.
        """
        mine = list(filter(self.is_mine, _processes()))
        places = self._places(probe, mine)
        if not places:
            self._refuse(probe, mine)
        if len(places) > 1:
            other = _other_command({pid for pid, _ in places}, mine)
            mistake = BY_ANOTHER.of(other=other) if other else TWICE
            raise Fail(self.wanted, f'{len(places)} nodes of the name {self.node}', mistake)
        [(pid, place)] = places
        process = next((each for each in mine if each.pid & 0xFFFF == pid), None)
        if process is None:
            raise Fail(self.wanted, f'{self.node} runs {place}', self._of(OTHER_PROGRAM))
        if process.create_time() + _OFF_SEC < self.changed():
            seen = f'it was started before the last change of {self.source}'
            raise Fail(self.wanted, seen, OLD_RUN)
        answers = self._answers(probe, process)
        if not _is_alive(process):
            seen = f'{self.node} was there, and its program has ended'
            raise Fail(self.wanted, seen, self._of(NOT_RUNNING))
        if not answers and self.has_to_answer:
            seen = f'{self.node} is on the graph, and does not answer'
            raise Fail(f'{self.node} answers', seen, self._of(NOT_SPUN))
        return process

    def refuse_ended(self, probe: Probe) -> None:
        """Raise Fail if its program does not run, as one that has ended meanwhile."""
        mine = list(filter(self.is_mine, _processes()))
        if not any(map(_is_alive, mine)):
            self._refuse(probe, mine)

    @property
    def wanted(self) -> str:
        """What is expected."""
        return f'{self.node} on the graph, from: {self.command}'

    def _answers(self, probe: Probe, process: Any) -> bool:
        """Tell whether the node answers, or can't be asked: it has no services of its own."""
        from labkit.asking.service_calls import wait_until_spun

        name, helper = f'{self.node}/list_parameters', probe.spun_node
        with probe.uncounted():
            if not probe.wait(
                lambda: name in dict(helper.get_service_names_and_types()), FOUND_SEC
            ):
                return True
            if not self.has_to_answer:
                return wait_until_spun(helper, self.node, ANSWER_SEC)
        # In several goes, since it may end meanwhile.
        answers = False
        while not answers and probe.time_left and _is_alive(process):
            answers = wait_until_spun(helper, self.node, min(ANSWER_SEC, probe.time_left))
        return answers

    def _of(self, mistake: Mistake) -> Mistake:
        name = self.node.rpartition('/')[2]
        return mistake.of(start=self.start, again=self.again, command=self.command, name=name)

    def _places(self, probe: Probe, mine: Sequence[Any]) -> list[tuple[int, str]]:
        """Return the process of each node of that name, and where it runs; wait for one of mine.

        A process is known by the lower 16 bits of its number.
        """
        from labkit.rosgraph.names import full_node_name
        from labkit.rosgraph.whose import is_missing, place, process_id

        helper = probe.spun_node

        def owners() -> list[bytes]:
            infos = helper.get_publishers_info_by_topic('/parameter_events')
            return [
                bytes(info.endpoint_gid)
                for info in infos
                if full_node_name(info.node_name, info.node_namespace) == self.node
                and not is_missing(bytes(info.endpoint_gid), helper)
            ]

        here = [each for each in mine if not self.elsewhere(each)]
        # A file may be run several times. `ros2 run` may stay beside its program, without a node.
        enough = any if self.joins else all

        def is_settled() -> bool:
            there = (bool(_nodes(probe, [each])) for each in here)
            return bool(owners()) or enough(there) or not any(map(_is_alive, here))

        if here:
            with probe.uncounted():
                probe.wait(is_settled, APPEAR_SEC)
        return [(process_id(gid), place(gid, helper)) for gid in owners()]

    def _refuse(self, probe: Probe, mine: Sequence[Any]) -> NoReturn:
        """Say why the node is not there."""
        from labkit.programs.children import is_at_work

        alive = list(filter(_is_alive, mine))
        if not alive:
            raise Fail(self.wanted, 'no such node', self._of(NOT_RUNNING))
        seen = next(filter(None, map(self.elsewhere, alive)), '')
        if seen:
            line = _how_to_join(alive)
            raise Fail(f'{self.wanted}, after {line}', seen, OTHER_DOMAIN.of(line=line))
        others = _nodes(probe, alive)
        if others:
            name = self.node.rpartition('/')[2]
            inside = next((each for each in others if each.rpartition('/')[2] == name), '')
            mistake = REMAPPED if '__node:=' in self.command else NODE_NAME
            if inside:
                mistake = IN_A_NAMESPACE.of(seen=inside)
            raise Fail(self.wanted, ', '.join(sorted(others)), self._of(mistake))
        # On a busy machine a program may need longer until it makes its node.
        if probe.wait(lambda: any(is_at_work(each.pid) for each in alive), AT_WORK_SEC):
            raise NotAttempted(
                f'Too early to tell: {self.command} was started, and its node is not there yet. '
                'Run this cell again.'
            )
        raise Fail(self.wanted, 'it runs, and no node has come', self._of(NOT_FOUND))

    def elsewhere(self, process: Any) -> str:
        """Say which other domain than this notebook's a process was given, '' if none.

        A number alone does not tell: with the profile of the domains between, it counts ports.
        """
        given = _variables(process)
        if given is None or (self.joins and not given.get('ROS_DOMAIN_ID')):
            return ''
        domain = given.get('ROS_DOMAIN_ID', '')
        if domain != os.environ.get('ROS_DOMAIN_ID', ''):
            return f'it runs with ROS_DOMAIN_ID={domain}' if domain else 'it has none: domain 0'
        if self.joins or domain_ids.counts_ports(given) == domain_ids.counts_ports():
            return ''
        profile = given.get(domain_ids.PROFILES_FILE)
        return f'it runs with {domain_ids.PROFILES_FILE}={profile or "nothing"}'


@dataclass(frozen=True)
class RunsFile(GraphClause):
    """A program of the learner's runs in a terminal: a file beside the notebook.

    Attributes:
        file: Its path, as it is typed: `'nodes/ear.py'`.
        nodes: Full names of its nodes. Several are made by several runs, each with its own name.
    """

    file: str
    nodes: Sequence[str]

    @property
    def text(self) -> str:
        """What is asked for."""
        if len(self.nodes) == 1:
            return WORDS.of(file=self.file, node=self.nodes[0]).clause('runs')
        names = ' and '.join(f'`{name}`' for name in self.nodes)
        return WORDS.of(file=self.file, names=names).clause('runs-each')

    @property
    def roles(self) -> dict[Role, str]:
        """Its nodes."""
        return {(NODE, name): '' for name in self.nodes}

    def find(self, evidence: Evidence) -> None:
        """Look for the file, and for its program."""
        if not self._path.is_file():
            self._refuse_without_file(evidence.probe)
        programs = [self._program(node) for node in self.nodes]
        found = {program.find(evidence.probe).pid for program in programs}
        if len(found) < len(programs):
            commands = ' and '.join(program.command for program in programs)
            raise Fail(
                f'a run of {self.file} for each node',
                'one run with all of them',
                ONE_FOR_ALL.of(commands=commands),
            )

    def explain_nothing(self, probe: Probe) -> None:
        """Say that a program has ended, which was there when it was looked for."""
        for node in self.nodes if self._path.is_file() else ():
            self._program(node).refuse_ended(probe)

    def process(self, evidence: Evidence) -> Any:
        """Return the process of its first node, as psutil has it. Raises what `find` does."""
        return self._program(self.nodes[0]).find(evidence.probe)

    def judge(self, evidence: Evidence) -> str:
        """Say where they run."""
        where = 'a terminal' if len(self.nodes) == 1 else f'{len(self.nodes)} terminals'
        return f'{self.file} runs in {where}.'

    @property
    def _path(self) -> Path:
        return Path.cwd() / self.file

    def _program(self, node: str) -> InATerminal:
        command = f'python3 {self.file}'
        if len(self.nodes) > 1:
            command += f' --ros-args -r __node:={node.lstrip("/")}'
        path = os.path.realpath(self._path)
        return InATerminal(
            node,
            command,
            start=f'In a terminal: {command}.',
            again='Then correct the file, and start it again.',
            source=self.file,
            is_mine=lambda process: path in _files(process),
            changed=lambda: os.stat(path).st_mtime,
        )

    def _refuse_without_file(self, probe: Probe) -> NoReturn:
        here = [name for name in self.nodes if probe.node_object(name) is not None]
        if here:
            raise Fail(
                f'the file {self.file}, run in a terminal',
                f'{here[0]} runs in this notebook, and there is no such file',
                NO_FILE.of(file=self.file),
            )
        folder, name = self._path.parent, self._path.name
        found = [path for place in (folder, Path.cwd()) for path in place.glob('*.*')]
        near = nearest(name, sorted(path.name for path in found if path.suffix in _TEXTS))
        if near:
            seen = next(path for path in found if path.name == near).relative_to(Path.cwd())
            raise Fail(f'the file {self.file}', f'the file {seen}', MISPLACED)
        raise NotAttempted(
            f'Not attempted yet. There is no {self.file}. Do what the task says, then run this '
            'cell again.'
        )


def _is_alive(process: Any) -> bool:
    """Tell whether a process, one of psutil, has not ended."""
    import psutil  # type: ignore[import-untyped]

    with suppress(psutil.Error):
        return bool(process.is_running() and process.status() != psutil.STATUS_ZOMBIE)
    return False


def _processes() -> list[Any]:
    import psutil

    return list(psutil.process_iter(['cmdline']))


def _other_command(numbers: Collection[int], mine: Sequence[Any]) -> str:
    """Return how a program was started that is none of these, and runs here; `''` if none does.

    Args:
        numbers: Ids of processes, their lower 16 bits.
        mine: Processes that are left out.
    """
    left = {each.pid for each in mine}
    for process in _processes():
        if process.pid & 0xFFFF in numbers and process.pid not in left:
            command: Sequence[str] = process.info['cmdline'] or ()
            words = [os.path.basename(word) for word in command[1:]]
            files = [word for word in words if word and not word.startswith('-')]
            # An interpreter is followed by what it runs, and a kernel by its connection file.
            if files and process.pid != os.getpid():
                return files[0]
    return ''


def _files(process: Any) -> list[str]:
    """Return the paths of the Python files that a command line names."""
    import psutil

    words: Sequence[str] = process.info['cmdline'] or ()
    named = [word for word in words[1:] if word.endswith('.py')]
    if not named:
        return []
    with suppress(psutil.Error, OSError):
        folder = process.cwd()
        return [os.path.realpath(os.path.join(folder, word)) for word in named]
    return []


def _nodes(probe: Probe, processes: Sequence[Any]) -> set[str]:
    """Return the full names of the nodes of processes, as far as they are known."""
    from labkit.rosgraph.names import UNKNOWN_NODE
    from labkit.rosgraph.whose import nodes_of

    numbers = {each.pid & 0xFFFF for each in processes}
    found = nodes_of(numbers, probe.spun_node)
    return {name for name in found if UNKNOWN_NODE not in name}


def _variables(process: Any) -> Mapping[str, str] | None:
    """Return the variables that a process was started with, None if it has ended."""
    import psutil

    with suppress(psutil.Error):
        found: Mapping[str, str] = process.environ()
        return found
    return None


def _how_to_join(processes: Sequence[Any]) -> str:
    """Return what is to be typed in the terminals of processes before they are started again."""
    found = filter(None, map(_variables, processes))
    # A profile that is set there and does not belong here has to be replaced.
    profile = domain_ids.THIS_MACHINE if any(map(domain_ids.counts_ports, found)) else None
    return domain_ids.how_to_join(domain_ids.read_domain_id() or 0, profile=profile)
