"""All looks, and the page about all kinds of faults."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from labkit.silent.frame_faults import look_at_frames
from labkit.silent.kinds import KINDS, Fault
from labkit.silent.matching_faults import look_at_history, look_at_pairs, look_at_servers
from labkit.silent.message_faults import look_at_messages
from labkit.silent.name_faults import look_at_kinds, look_at_names, look_at_nodes
from labkit.silent.parameter_faults import (
    look_at_files,
    look_at_parameters,
    look_at_readers,
    look_at_rules,
)
from labkit.silent.scene import Scene
from labkit.silent.spinning_faults import (
    look_at_calls,
    look_at_ends,
    look_at_executors,
    look_at_making,
    look_at_spinning,
)
from labkit.silent.timing_faults import look_at_callbacks, look_at_clocks, look_at_timers

__all__ = ['AT_GRAPH', 'AT_NODES', 'KINDS', 'page']

Look = Callable[[Scene], Iterator[Fault]]

AT_GRAPH: tuple[Look, ...] = (
    *(look_at_names, look_at_kinds, look_at_nodes, look_at_pairs, look_at_servers),
)
"""What is looked at when the graph has changed."""

AT_NODES: tuple[Look, ...] = (
    *(look_at_history, look_at_parameters, look_at_files, look_at_rules, look_at_clocks),
    *(look_at_timers, look_at_callbacks, look_at_spinning, look_at_calls, look_at_ends),
    *(look_at_executors, look_at_making, look_at_readers, look_at_messages, look_at_frames),
)
"""What is looked at each time: it is about this process alone."""

_TITLES = {
    'names': 'Names',
    'types': 'Types',
    'qos': 'Quality of service',
    'parameters': 'Parameters',
    'remap': 'Remapping',
    'time': 'Time',
    'life': 'Life of nodes, calls and callbacks',
    'messages': 'Content of messages',
    'frames': 'Frames',
}
_ALIKE = tuple(
    f'names.{way}'
    for way in ('namespace', 'absolute', 'private', 'case', 'underscore', 'plural', 'spelling')
)
_HEAD = """\
<!-- Made by `python3 -m labkit docs` from labkit/silent. -->
# Faults that ROS 2 keeps to itself

Nothing arrives, nothing happens, and there is no error message. The notebook sees both ends, so it
says what is wrong: under the cell that made the node, on the node's card, in `lab.graph()`,
`lab.monitor()`, `lab.doctor()` and `%ros2 doctor`. It goes away when it is mended.

There are {all} kinds. Each can happen with rclpy, and tf2 for frames, and has a test. {alone} are
told by nobody else: neither by rclpy nor by `ros2` nor by another tool of ROS.
"""

# What was wrong, number of questions, whether a program of rclpy can do it, kinds that tell it.
STUDY = (
    ('several publishers where one is meant', 7, True, ()),
    ('a subscriber without a publisher', 11, True, _ALIKE),
    ('a client without a server', 4, True, ('names.service', 'names.action', 'life.no-server')),
    ('a parameter that the node does not have', 2, True, ('parameters.undeclared',)),
    ('a parameter that is missing', 2, True, ()),
    ('real time beside simulated time', 4, True, ('time.no-clock', 'time.two-clocks')),
    ('other values that do not go together', 17, True, ()),
    ('profiles that do not match', 1, True, ('qos.reliability',)),
    ('two nodes of one name', 1, True, ('names.double',)),
    ('frames without, or with two, parents', 11, True, ('frames.two-parents', 'frames.apart')),
    ('a surrounding for which the node is not made', 2, False, ()),
)
_STUDY = """\
## Beside a study of public questions

P. Canelas and others have sorted questions of ROS Answers (ISSTA 2024, arXiv:2407.19292): 12
kinds and 50 sub-kinds of misconfiguration, 27 of which no tool finds. The list of the 50 was not
at hand for this page, so the two lists are not laid beside each other. The authors have published
{all} such questions as specifications for a tool (github.com/pcanelas/rospec). Sorted by the first
fault that it reports: {made} can be made in a program of rclpy and tf2, and {told} are of a sort
that is told here, if both ends are there to be seen. The rest needs what only the author of a node
knows (which values go together, how many publishers are meant).

| What was wrong | Questions | Can be made here | Told here |
|---|---|---|---|
"""


def _beside_the_study() -> Iterator[str]:
    counts = {
        'all': sum(count for _, count, _, _ in STUDY),
        'made': sum(count for _, count, made, _ in STUDY if made),
        'told': sum(count for _, count, _, ids in STUDY if ids),
    }
    yield _STUDY.format(**counts).rstrip()
    for what, count, made, ids in STUDY:
        told = ', '.join(f'`{KINDS[id].id}`' for id in ids) or 'no'
        yield f'| {what} | {count} | {"yes" if made else "no"} | {told} |'


def page() -> str:
    """Return docs/faults.md."""
    groups: dict[str, list[str]] = {}
    for one in KINDS.values():
        lines = [f'### {one.title}', '', f'{one.todo}', '']
        if one.guess:
            lines += [f'- It is a guess: {one.guess}.']
        if not one.aloud:
            lines += ['- It is shown where one looks for faults, not under the cell.']
        lines += [f'- Not told if {one.quiet}.', f'- Told elsewhere: {one.others}.']
        lines += [f'- Its name here: `{one.id}`.', '']
        groups.setdefault(one.id.partition('.')[0], []).extend(lines)
    alone = sum(one.others == 'nobody' for one in KINDS.values())
    text = [_HEAD.format(all=len(KINDS), alone=alone)]
    for group, title in _TITLES.items():
        text += [f'## {title}', '', *groups[group]]
    return '\n'.join([*text, *_beside_the_study()]).rstrip() + '\n'
