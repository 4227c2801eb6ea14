"""What a task asks of a system that a launch file starts, clause by clause."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from labkit.exercises import Clause, Fail, Mistake, words_of
from labkit.lessons.names_and_launch.learner_launch import Names, System

__all__ = ['HasParameters', 'Hears', 'Launches', 'OnlyNodes', 'Publishes', 'RunsNode']

WORDS = words_of(__file__)

# Topics that every node has.
_COMMON = {'/rosout', '/parameter_events'}

FAULT = WORDS.mistake('launch/fault')
NAMESPACE = WORDS.mistake('launch/namespace')
NODE_NAME = WORDS.mistake('launch/node-name')
NODE_CAPITALS = WORDS.mistake('launch/node-capitals')
NO_NODE = WORDS.mistake('launch/no-node')
NOTHING = WORDS.mistake('launch/nothing')
TOO_MANY = WORDS.mistake('launch/too-many')
TWICE = WORDS.mistake('launch/twice')
NO_REMAP = WORDS.mistake('launch/no-remap')
NO_MATCH = WORDS.mistake('launch/no-match')
ABSOLUTE = WORDS.mistake('launch/absolute')
WITHIN = WORDS.mistake('launch/within')
OTHER_TOPIC = WORDS.mistake('launch/other-topic')
NO_TOPIC = WORDS.mistake('launch/no-topic')
DEFAULT_VALUE = WORDS.mistake('launch/default-value')
OTHER_VALUE = WORDS.mistake('launch/other-value')


class Launches(Clause[System]):
    """The file is launched without a fault."""

    def __init__(self, name: str) -> None:
        self._name = name

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(name=self._name).clause('launches')

    def judge(self, system: System) -> str:
        """Raise Fail if nothing was started."""
        if system.fault is not None:
            told = system.fault
            mistake = FAULT.then(told.todo) if told.todo else FAULT
            raise Fail('a launch file without a fault', str(told.message), mistake)
        return ''


@dataclass(frozen=True)
class RunsNode(Clause[System]):
    """A node runs. In its name, `{...}` stands for an argument of the file."""

    node: str
    words: str

    def judge(self, system: System) -> str:
        """Raise Fail if it does not."""
        refuse_missing(system, self.node.format_map(system.values), space=_space(self.node))
        return ''


@dataclass(frozen=True)
class OnlyNodes(Names):
    """These nodes run, and no others."""

    nodes: Sequence[str]
    words: str

    def judge(self, system: System) -> str:
        """Raise Fail if one is missing, or one is too many."""
        from labkit.rosgraph.snapshot import node_names

        wanted = [node.format_map(system.values) for node in self.nodes]
        for node in wanted:
            refuse_missing(system, node)
        expected = f'{", ".join(wanted)}, and no others'
        more = [node for node in system.nodes if node not in wanted]
        if more:
            raise Fail(expected, f'{", ".join(more)} as well', TOO_MANY)
        there = node_names(system.probe.spun_node)
        twice = [node for node in wanted if there.count(node) > 1]
        programs = [one.name for one in system.launch.processes]
        if twice or len(programs) > len(wanted):
            seen = f'{twice[0]} twice' if twice else f'programs: {", ".join(programs)}'
            raise Fail(expected, seen, TWICE if twice else TOO_MANY)
        return ''


def _space(node: str) -> str:
    """Return the namespace of a node as a file says it: `{robot}` is an argument there."""
    space = node.rpartition('/')[0].lstrip('/') or '/'
    return space.replace('{', '$(var ').replace('}', ')')


def refuse_missing(system: System, node: str, *, space: str = '') -> None:
    """Raise Fail if a node does not run; those that are wanted, too, are not meant to be it.

    Args:
        system: What runs.
        node: Its full name.
        space: Its namespace as the file is to say it, if that is not the one of its name.
    """
    if node in system.nodes:
        return
    told, (space, _, base) = space or _space(node), node.rpartition('/')
    others = [one for one in system.nodes if one not in system.wanted]
    alike = next((one for one in others if one.lower() == node.lower()), '')
    if not system.launch.processes:
        mistake = NOTHING
    elif alike:
        mistake = NODE_CAPITALS.of(seen=alike, wanted=node)
    elif any(one.endswith(f'/{base}') for one in others):
        mistake = NAMESPACE.of(space=told)
    elif any(one.startswith(f'{space}/') for one in others):
        mistake = NODE_NAME.of(base=base)
    else:
        mistake = NO_NODE
    raise Fail(f'the node {node}', ', '.join(system.nodes) or 'no node', mistake)


@dataclass(frozen=True)
class _HasTopic(Clause[System]):
    """A node has a publisher on a topic, or a subscription to it.

    Attributes:
        node: Its full name.
        topic: The full name of the topic.
        code: The name of the topic in the node's code.
        words: What is asked for.
    """

    node: str
    topic: str
    code: str
    words: str

    def _has(self, system: System, does: str, found: Mapping[str, set[str]]) -> None:
        node, topic = (name.format_map(system.values) for name in (self.node, self.topic))
        refuse_missing(system, node, space=_space(self.node))
        seen = sorted(found.get(node, set()) - _COMMON)
        if topic in seen:
            return
        raise Fail(
            f'{node} {does} {topic}',
            f'it {does}: {", ".join(seen) or "no topic"}',
            self._why(node, topic, seen, system.remaps(node)).of(
                code=self.code, topic=topic, node=node, does=does.partition(' ')[0]
            ),
        )

    def _why(
        self, node: str, topic: str, seen: Sequence[str], remaps: Sequence[tuple[str, str]]
    ) -> Mistake:
        space = node.rpartition('/')[0]
        if not seen:
            return NO_TOPIC
        if f'{space}/{self.code}' in seen:
            return NO_MATCH.of(given=remaps[0][0]) if remaps else NO_REMAP
        if f'/{topic.rpartition("/")[2]}' in seen:
            return ABSOLUTE
        return WITHIN if f'{space}{topic}' in seen else OTHER_TOPIC


class Publishes(_HasTopic):
    """A node publishes on a topic."""

    def judge(self, system: System) -> str:
        """Raise Fail if it does not."""
        self._has(system, 'publishes on', system.publishes)
        return ''


class Hears(_HasTopic):
    """A node subscribes to a topic."""

    def judge(self, system: System) -> str:
        """Raise Fail if it does not."""
        self._has(system, 'subscribes to', system.hears)
        return ''


@dataclass(frozen=True)
class HasParameters(Clause[System]):
    """Parameters of a node have values.

    Attributes:
        node: Its full name.
        values: The values; text stands for an argument of the file.
        defaults: The values that its code declares.
        words: What is asked for.
    """

    node: str
    values: Mapping[str, float | str]
    words: str
    defaults: Mapping[str, float] = field(default_factory=dict)

    def judge(self, system: System) -> str:
        """Raise Fail if one has another value."""
        node = self.node.format_map(system.values)
        refuse_missing(system, node, space=_space(self.node))
        found = system.parameters(node)
        for name, value in self.values.items():
            wanted = float(f'{value}'.format_map(system.values))
            if found.get(name) != wanted:
                default = found.get(name) == self.defaults.get(name)
                raise Fail(
                    f'the parameter {name} of {node} is {wanted}',
                    f'{found[name]}' if name in found else f'it has {", ".join(found)}',
                    (DEFAULT_VALUE if default else OTHER_VALUE).of(name=name),
                )
        return ''
