"""What a task asks of a program that the learner runs in a terminal: its node is there now."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NoReturn

from labkit.exercises import Fail, Mistake, words_of
from labkit.lessons.package.content import APPEAR_SEC, NODE_NAME, Runs, Work, refuse_program

__all__ = ['Running']

WORDS = words_of(__file__)

# In so many seconds a new client finds a node also on a busy machine.
ANSWER_SEC = 4.0
# The start of a process is known to a second.
_OFF_SEC = 1.5

NOT_RUNNING = WORDS.mistake('package/not-running')
OTHER_DOMAIN = WORDS.mistake('package/other-domain')
NOT_FOUND = WORDS.mistake('package/not-found')
OTHER_PROGRAM = WORDS.mistake('package/other-program')
TWICE = WORDS.mistake('package/twice')
OLD_RUN = WORDS.mistake('package/old-run')
NOT_SPUN = WORDS.mistake('package/not-spun')


@dataclass(frozen=True)
class Running(Runs):
    """A program of the package runs in a terminal, and its node is on the graph."""

    @property
    def text(self) -> str:
        """What is asked for."""
        told = WORDS.of(package=self.package, program=self.program, node=self.node)
        return told.clause('runs-in-a-terminal')

    def judge(self, work: Work) -> str:
        """Raise Fail unless it is there, started from what is built now."""
        from labkit.asking.service_calls import wait_until_spun

        if self.program not in work.programs:
            refuse_program(self.program, work)
        helper, node = work.probe.spun_node, f'/{self.node}'
        wanted = f'{node} on the graph, from: ros2 run {self.package} {self.program}'
        mine = list(self._processes(work))
        places = self._places(work, mine)
        if not places:
            self._refuse(work, wanted, mine)
        if len(places) > 1:
            raise Fail(wanted, f'{len(places)} nodes of the name {node}', TWICE)
        [(pid, place)] = places
        process = next((each for each in mine if each.pid & 0xFFFF == pid), None)
        if process is None:
            mistake = OTHER_PROGRAM.of(package=self.package, program=self.program)
            raise Fail(wanted, f'{node} runs {place}', mistake)
        if process.create_time() + _OFF_SEC < work.changed:
            raise Fail(wanted, 'files in src that are newer than the program that runs', OLD_RUN)
        # One that was made without services of its own can't be asked.
        answers = not self._has_services(work)
        # In several goes, since it may end meanwhile.
        while not answers and work.probe.time_left and _is_alive(process):
            answers = wait_until_spun(helper, node, min(ANSWER_SEC, work.probe.time_left))
        if not _is_alive(process):
            raise Fail(wanted, f'{node} was there, and its program has ended', self._not_running)
        if not answers:
            raise Fail(f'{node} answers', f'{node} is on the graph, and does not answer', NOT_SPUN)
        work.ran.append(self.program)
        return ''

    @property
    def _not_running(self) -> Mistake:
        return NOT_RUNNING.of(package=self.package, program=self.program)

    def _has_services(self, work: Work) -> bool:
        """Tell whether the node has the services of parameters, which come after its name."""
        name, helper = f'/{self.node}/list_parameters', work.probe.spun_node
        with work.probe.uncounted():
            return work.wait(lambda: name in dict(helper.get_service_names_and_types()))

    def _processes(self, work: Work) -> Iterator[Any]:
        """Yield the processes of the program, and of a `ros2 run` that is about to become one."""
        import psutil  # type: ignore[import-untyped]

        path = os.path.realpath(work.program(self.program))
        for process in psutil.process_iter(['cmdline']):
            words: Sequence[str] = process.info['cmdline'] or ()
            named = [word for word in words if word.endswith(f'/{self.package}/{self.program}')]
            starts = (self.package, self.program) in pairwise(words)
            if starts or path in map(os.path.realpath, named):
                yield process

    def _places(self, work: Work, mine: Sequence[Any]) -> list[tuple[int, str]]:
        """Return the process of each node of that name, and where it runs; wait for one of mine.

        A process is known by the lower 16 bits of its number.
        """
        from labkit.rosgraph.names import full_node_name
        from labkit.rosgraph.whose import is_missing, place, process_id

        helper = work.probe.spun_node

        def owners() -> list[bytes]:
            infos = helper.get_publishers_info_by_topic('/parameter_events')
            return [
                bytes(info.endpoint_gid)
                for info in infos
                if full_node_name(info.node_name, info.node_namespace) == f'/{self.node}'
                and not is_missing(bytes(info.endpoint_gid), helper)
            ]

        if mine and not _other_domain(mine):
            with work.probe.uncounted():
                work.probe.wait(
                    lambda: owners() or _nodes(work, mine) or not any(map(_is_alive, mine)),
                    APPEAR_SEC,
                )
        return [(process_id(gid), place(gid, helper)) for gid in owners()]

    def _refuse(self, work: Work, wanted: str, mine: Sequence[Any]) -> NoReturn:
        """Say why the node is not there."""
        alive = list(filter(_is_alive, mine))
        if not alive:
            raise Fail(wanted, 'no such node', self._not_running)
        others = _nodes(work, alive)
        if others:
            raise Fail(wanted, ', '.join(sorted(others)), NODE_NAME.of(node=self.node))
        domain = _other_domain(alive)
        if domain:
            own = os.environ.get('ROS_DOMAIN_ID', '')
            raise Fail(
                f'{wanted}, with ROS_DOMAIN_ID={own}',
                f'it runs with ROS_DOMAIN_ID={domain}',
                OTHER_DOMAIN.of(domain=own),
            )
        raise Fail(wanted, 'it runs, and no node has come', NOT_FOUND)


def _is_alive(process: Any) -> bool:
    import psutil

    with suppress(psutil.Error):
        return bool(process.is_running() and process.status() != psutil.STATUS_ZOMBIE)
    return False


def _nodes(work: Work, processes: Sequence[Any]) -> set[str]:
    """Return the full names of the nodes of processes, as far as they are known."""
    from labkit.rosgraph.names import UNKNOWN_NODE
    from labkit.rosgraph.whose import nodes_of

    numbers = {each.pid & 0xFFFF for each in processes}
    found = nodes_of(numbers, work.probe.spun_node)
    return {name for name in found if UNKNOWN_NODE not in name}


def _other_domain(processes: Sequence[Any]) -> str:
    """Return the domain that a process was given, if it is not that of this notebook."""
    import psutil

    for process in processes:
        with suppress(psutil.Error):
            domain: str = process.environ().get('ROS_DOMAIN_ID', '')
            if domain not in ('', os.environ.get('ROS_DOMAIN_ID', '')):
                return domain
    return ''
