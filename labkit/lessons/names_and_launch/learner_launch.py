"""A launch file of the learner's, launched by the check, for each set of arguments once."""

from __future__ import annotations

import contextlib
import os
import signal
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labkit import stop_button
from labkit.errors import LabError
from labkit.exercises import Clause, Fail, NotAttempted, Probe, Stage, words_of
from labkit.exercises.exercise import NOTHING_YET
from labkit.exercises.figures import figure
from labkit.exercises.machine_faults import refuse_machine_fault
from labkit.lessons._terminal import AT_WORK_SEC
from labkit.lessons.package.learner_workspace import workspace

if TYPE_CHECKING:
    from labkit.launching.launched import Launch, Program

__all__ = ['EMPTY', 'Launched', 'Names', 'System']

WORDS = words_of(__file__)

EMPTY = '<launch>\n  <!-- ... -->\n</launch>'
_FORMS = ('xml', 'yaml', 'py')
# What timers start within so long a time belongs to the beginning, s.
SOON_SEC = 3.0

RUNS_ALREADY = WORDS.mistake('launch/runs-already')
DIED = WORDS.mistake('launch/died')
HANGS = WORDS.mistake('launch/hangs')
LATER = WORDS.mistake('launch/later')


@dataclass
class System:
    """What a launch file has started.

    Attributes:
        probe: The probe of the check.
        path: The launch file.
        values: Its arguments, given or by default, for the names and values in clauses.
        launch: The launch.
        fault: The reason for which nothing was started.
        publishes: The topics on which each node publishes, by its full name.
        hears: The topics to which each node subscribes, likewise.
        programs: The program of each node, where its topics tell.
        wanted: The full names of the nodes that the file has to start.
    """

    probe: Probe
    path: Path
    values: Mapping[str, str]
    launch: Launch
    fault: LabError | None = None
    publishes: dict[str, set[str]] = field(default_factory=dict)
    hears: dict[str, set[str]] = field(default_factory=dict)
    programs: dict[str, Program] = field(default_factory=dict)
    wanted: Sequence[str] = ()

    @property
    def nodes(self) -> list[str]:
        """Return the full names of its nodes."""
        return self.launch.nodes

    def wait(self, condition: Callable[[], object]) -> bool:
        """Wait until something is true that programs do, however busy the machine is."""
        with self.probe.uncounted():
            return self.probe.wait(condition)

    def parameters(self, node: str) -> dict[str, Any]:
        """Return the parameters of a node."""
        from labkit.asking.parameter_calls import get_parameters, parameter_names
        from labkit.rosgraph.parameter_values import python_value

        names = parameter_names(self.probe.spun_node, node)
        values = get_parameters(self.probe.spun_node, node, names)
        return {name: python_value(value) for name, value in values.items()}

    def remaps(self, node: str) -> list[tuple[str, str]]:
        """Return the remaps that the program of a node was given: a name, and what it is to be."""
        import psutil  # type: ignore[import-untyped]

        try:
            words = psutil.Process(self.programs[node].pid).cmdline()
        except (KeyError, psutil.NoSuchProcess):
            return []
        rules = [word.partition(':=') for before, word in pairwise(words) if before == '-r']
        return [(old, new) for old, _, new in rules if not old.startswith('__')]

    def kill(self, node: str) -> Program:
        """Let the program of a node die, and return it when the launch knows."""
        program = self.programs[node]
        before = program.starts
        if program.exit_code is None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(program.pid, signal.SIGKILL)
        self.wait(lambda: program.exit_code is not None or program.starts > before)
        return program

    def look(self, before: Mapping[str, int]) -> None:
        """Read off the graph what its nodes do.

        Args:
            before: How often each name of a node was there before.

        Raises:
            Fail: A node was there before; a program has died, or hangs.
        """
        from labkit.asking.service_calls import wait_until_spun
        from labkit.rosgraph.whose import process_id

        helper = self.probe.spun_node
        _refuse_running(self.nodes, before)
        self._refuse_late()
        with self.probe.uncounted():
            left = self.probe.time_left
            hanging = next((n for n in self.nodes if not wait_until_spun(helper, n, left)), '')
        if hanging:
            # One that does not answer may be about to end.
            self.wait(lambda: any(one.exit_code is not None for one in self.launch.processes))
        self._refuse_dead()
        if hanging:
            raise Fail(f'{hanging} answers', f'{hanging} does not answer', HANGS)
        for ends, found in (
            (self.probe.all_publishers(), self.publishes),
            (self.probe.all_subscriptions(), self.hears),
        ):
            for end in ends:
                found.setdefault(end.node, set()).add(end.topic)
                for program in self.launch.processes:
                    if program.pid & 0xFFFF == process_id(end.gid):
                        self.programs[end.node] = program

    def refuse_later(self) -> None:
        """Raise Fail if something is to be started that the check can not wait for."""
        if self.launch.timers:
            seconds = max(self.launch.timers)
            raise Fail(
                'all that the file starts, when it is launched',
                f'a timer that starts something {figure(seconds)} s later',
                LATER,
            )

    def _refuse_late(self) -> None:
        """Raise NotAttempted if a program is about to make its node: the machine is busy."""
        from labkit.programs.child_processes import gids_in
        from labkit.programs.children import is_at_work
        from labkit.rosgraph.whose import process_id

        there = {process_id(gid) for gid in gids_in(self.probe.spun_node)}
        for one in self.launch.processes:
            is_late = one.is_node and one.exit_code is None and one.pid & 0xFFFF not in there
            # Who sleeps in a loop of its own, and makes no node, is not about to make one.
            if is_late and self.probe.wait(lambda: is_at_work(one.pid), AT_WORK_SEC):  # noqa: B023
                raise NotAttempted(
                    f'Too early to tell: {one.name} was started, and its node is not there yet. '
                    'Run this cell again.'
                )

    def _refuse_dead(self) -> None:
        for program in self.launch.processes:
            if program.exit_code is not None or program.starts > 1:
                said = self._output_of(program.name)
                refuse_machine_fault(said, program.exit_code)
                last = said[-1] if said else 'nothing'
                raise Fail(f'{program.name} runs', f'it has ended, and said at last: {last}', DIED)

    def _output_of(self, program: str) -> list[str]:
        ended, start = f'[{program}]: process has ', f'[{program}] '
        self.wait(lambda: any(ended in line for line in self.launch.output))
        output = self.launch.output
        return [line.removeprefix(start) for line in output if line.startswith(start)]


def _refuse_running(nodes: Iterable[str], before: Mapping[str, int]) -> None:
    for node in nodes:
        if before.get(node):
            raise Fail(
                f'no node of the name {node} before the check starts one',
                f'{node} is running already',
                RUNS_ALREADY,
            )


class Names(Clause[System]):
    """A clause that names nodes which the file has to start.

    Attributes:
        nodes: Their full names, with the names of arguments in braces.
    """

    nodes: Sequence[str]


@dataclass(frozen=True)
class Launched(Stage[System]):
    """A launch file in the learner's workspace, in XML, YAML or Python.

    Attributes:
        name: Its name, without the ending.
        given: Its content as the lesson gives it, which shows no attempt.
        arguments: Draws the arguments of each launch.
        defaults: The values that its arguments have to have by default.
    """

    name: str
    given: str = EMPTY
    arguments: Callable[[], Sequence[Mapping[str, str]]] = lambda: [{}]
    defaults: Mapping[str, str] = field(default_factory=dict)

    @contextmanager
    def scenes(
        self, probe: Probe, clauses: Sequence[Clause[System]]
    ) -> Iterator[Iterator[System]]:
        """Launch it with each set of arguments, and end it after each."""
        path = self._path()
        names = [node for each in clauses if isinstance(each, Names) for node in each.nodes]
        played = self._play(probe, path, names)
        try:
            yield played
        finally:
            with stop_button.undoing():
                played.close()

    def tell(self, seen: Sequence[System]) -> str:
        """Say what was started."""
        nodes = dict.fromkeys(node for system in seen for node in system.nodes)
        return f'{seen[0].path.name} has started {", ".join(nodes)}.'

    def _path(self) -> Path:
        folder = workspace()
        if folder is None:
            raise NotAttempted(NOTHING_YET)
        found = [folder / f'{self.name}.launch.{form}' for form in _FORMS]
        found = sorted((path for path in found if path.is_file()), key=os.path.getmtime)
        texts = [path.read_text(encoding='utf-8', errors='replace').strip() for path in found]
        if not found or texts[-1] == self.given.strip():
            raise NotAttempted(NOTHING_YET)
        return found[-1]

    def _play(
        self, probe: Probe, path: Path, names: Sequence[str]
    ) -> Generator[System, None, None]:
        for arguments in self.arguments():
            values = {**self.defaults, **arguments}
            wanted = [name.format_map(values) for name in names]
            with _launched(probe, path, arguments, wanted) as system:
                system.values = values
                yield system


@contextmanager
def _launched(
    probe: Probe, path: Path, arguments: Mapping[str, str], wanted: Sequence[str]
) -> Iterator[System]:
    """Launch a file, after the end of earlier launches of it, and end it.

    Raises:
        Fail: One of the nodes that are wanted is there before; nothing was launched.
    """
    from labkit.background.runtime import runtime
    from labkit.launching.launched import Launch
    from labkit.programs.child_processes import keep, processes
    from labkit.rosgraph.snapshot import node_names

    for earlier in processes():
        if isinstance(earlier, Launch) and earlier.path == str(path) and earlier.running:
            earlier.stop()
    before = Counter(node_names(probe.spun_node))
    _refuse_running(wanted, before)
    cell = runtime.console.current_cell()
    launch = keep(Launch(f'launch of {path.name}', str(path), arguments, cell))
    system = System(probe, path, arguments, launch, wanted=wanted)
    try:
        with probe.uncounted():
            try:
                launch.wait_until_begun(probe.spun_node, list(before.elements()))
                # What a timer is to start was seen before anything was started.
                if launch.timers and max(launch.timers) <= SOON_SEC:
                    system.wait(lambda: not launch.timers or not launch.running)
                    launch.wait_until_begun(probe.spun_node, list(before.elements()))
            except LabError as fault:
                system.fault = fault
            else:
                system.refuse_later()
                system.look(before)
        yield system
    finally:
        launch.stop()
