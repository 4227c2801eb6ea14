"""What a node is given from outside and does not take: parameters, files of them, remappings."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from labkit.errors import first_few, nearest, quoted
from labkit.rosgraph.names import EVERY_NODE_HAS, EVERY_NODE_OFFERS
from labkit.rosgraph.parameter_files import is_meant
from labkit.silent.kinds import Fault, kind
from labkit.silent.name_faults import alike, nearest_of
from labkit.silent.scene import OwnNode, ParameterFile, Rule, Scene

__all__ = ['look_at_files', 'look_at_parameters', 'look_at_readers', 'look_at_rules']

UNDECLARED = kind(
    'parameters.undeclared',
    'The parameter has no effect: it is given, and the node never declares it',
    'Declare it in the node (declare_parameter), or write the name that is declared.',
    'a file gives it to all nodes, and one of them declares it',
)
FILE_NODE = kind(
    'parameters.file-node',
    'The params file has no effect: it is for a node of another name',
    'Write the full name of the node in the file, or /** for all nodes.',
    'the file has the name of at least one node',
)
FILE_NAMESPACE = kind(
    'parameters.file-namespace',
    'The params file has no effect: the node is in a namespace',
    'Write the namespace in front of the name of the node, or /**/ for any.',
    'the file has the name of at least one node',
)
WILDCARD = kind(
    'parameters.wildcard',
    'The value for one node has no effect: /** follows it in the params file and wins',
    'Put /** first: what comes later in the file wins.',
    '/** comes first, or both have the same value',
)
UNMATCHED = kind(
    'remap.unmatched',
    'The remapping has no effect: the node has no name that it could replace',
    'Write the name that the node uses, as ros2 node info shows it.',
    'a name of the node is replaced',
)
CHAIN = kind(
    'remap.chain',
    'The remapping stops half way: a rule is not applied to what another rule has made',
    'Write one rule that leads to the last name.',
    'no rule begins where another one ends',
)
OTHER_NODE = kind(
    'remap.other-node',
    'The remapping has no effect: it is for a node of another name',
    'Write the name of the node in front of the rule, or leave it away.',
    'a node of that name is there',
)

READ_ONCE = kind(
    'parameters.read-once',
    'ros2 param set has no effect: the node has read the parameter once, in __init__',
    'Read it where it is used, self.get_parameter(name).value, or change what depends on it in a '
    'callback: self.add_post_set_parameters_callback(self.on_change).',
    'a method, a callback or a function of the notebook reads parameters, too, or a callback '
    'takes new values',
)

_OF_EVERY_NODE = {'use_sim_time', 'start_type_description_service'}


def look_at_parameters(scene: Scene) -> Iterator[Fault]:
    """Find parameters that a node is given and never declares."""
    declared_by_any = {name for node in scene.nodes for name in node.declared}
    for node in scene.nodes:
        for_all = _for_all(node)
        for name in sorted(node.overrides - node.declared - _OF_EVERY_NODE):
            if name.startswith('qos_overrides.'):
                continue
            near = nearest(name, sorted(node.declared - _OF_EVERY_NODE))
            if name in for_all and (name in declared_by_any or not near):
                continue
            known = sorted(node.declared - _OF_EVERY_NODE)
            has = f'declares {first_few(known)}' if known else 'declares none'
            hint = f'Did you mean {near!r}? ' if near else ''
            yield Fault(
                UNDECLARED,
                (node.name,),
                name,
                f'{node.name} is given the parameter {name!r}, which it never declares: it {has}.',
                hint + UNDECLARED.todo,
            )


def look_at_readers(scene: Scene) -> Iterator[Fault]:
    """Find parameters that were set in vain: their node does not read them again."""
    for node in scene.nodes:
        for name, before, now in node.unread:
            if name not in _OF_EVERY_NODE and not name.startswith('qos_overrides.'):
                yield Fault(
                    READ_ONCE,
                    (node.name,),
                    name,
                    f'The parameter {name!r} of {node.name} was set to {quoted(now)}, but its '
                    'class reads parameters in __init__ alone: the node goes on with '
                    f'{quoted(before)}.',
                )


def _for_all(node: OwnNode) -> set[str]:
    """Return the parameters that files give to a node as to any other."""
    files = (*node.files, *node.shared_files)
    return {
        name
        for file in files
        for key, values in file.sections
        if '*' in key and is_meant(key, node.name)
        for name in values
    }


def look_at_files(scene: Scene) -> Iterator[Fault]:
    """Find parameter files that no node takes, or whose order defeats them."""
    for node in scene.nodes:
        for file in node.files:
            yield from _file(file, [node])
    for file in dict.fromkeys(file for node in scene.nodes for file in node.shared_files):
        yield from _file(file, [node for node in scene.nodes if file in node.shared_files])


def _file(file: ParameterFile, nodes: Sequence[OwnNode]) -> Iterator[Fault]:
    keys = [key for key, _ in file.sections]
    if keys and not any(is_meant(key, node.name) for key in keys for node in nodes):
        pairs = [(key, node) for key in keys for node in nodes]
        last = [pair for pair in pairs if _last(pair[0]) == _last(pair[1].name)]
        near = last or [pair for pair in pairs if alike(_last(pair[0]), _last(pair[1].name))]
        key, node = (near or pairs)[0]
        yield Fault(
            FILE_NAMESPACE if last else FILE_NODE,
            (node.name,),
            file.path,
            f'{file.path} has parameters for {first_few(keys)}, but the node is called '
            f'{node.name}: it takes none of them.',
            f'Write {node.name} instead of {key}, or /** for all nodes.',
            aloud=bool(near) or len(nodes) == 1,
        )
    for node in nodes:
        given: dict[str, tuple[str, object]] = {}
        for key, values in file.sections:
            if not is_meant(key, node.name):
                continue
            for name, value in values.items():
                before = given.get(name)
                if before and '*' in key and '*' not in before[0] and before[1] != value:
                    yield Fault(
                        WILDCARD,
                        (node.name,),
                        name,
                        f'{file.path} sets {name!r} of {node.name} to {before[1]!r}, and then, '
                        f'under {key}, to {value!r}: that wins.',
                    )
                given[name] = (key, value)


def look_at_rules(scene: Scene) -> Iterator[Fault]:
    """Find remapping rules that replace nothing, or not what they seem to."""
    for node in scene.nodes:
        yield from _rules(node.rules, [node], alone=True)
    for rules in dict.fromkeys(node.shared_rules for node in scene.nodes if node.shared_rules):
        taking = [node for node in scene.nodes if node.shared_rules == rules]
        yield from _rules(rules, taking, alone=False)


def _rules(rules: Sequence[Rule], nodes: Sequence[OwnNode], *, alone: bool) -> Iterator[Fault]:
    for rule in rules:
        meant = [node for node in nodes if rule.node in ('', _last(node.name), node.name)]
        if not meant:
            near = nearest_of(rule.node, [_last(node.name) for node in nodes])
            yield Fault(
                OTHER_NODE,
                (nodes[0].name,),
                str(rule),
                f'The rule {rule} is for a node called {rule.node}, but the node is called '
                f'{near or _last(nodes[0].name)}.',
                aloud=alone or bool(near),
            )
            continue
        # A name that was replaced is not in the graph any more, but what it was replaced by is.
        if any(_full(rule.new, node) in set(node.ends()) for node in meant):
            continue
        first = next(
            (r for r in rules if r is not rule and r.new == rule.old and r.node == rule.node), None
        )
        if first is not None:
            yield Fault(
                CHAIN,
                (meant[0].name,),
                str(rule),
                f'{first} makes {rule.old}, and {rule} is not applied to that: a name is '
                'replaced once.',
            )
            continue
        pairs = [
            (node, near)
            for node in meant
            for near in [nearest_of(_full(rule.old, node), sorted(_own_names(node)))]
        ]
        node, near = next((pair for pair in pairs if pair[1]), pairs[0])
        names = ', '.join(sorted(_own_names(node))[:3]) or 'no topic and no service'
        yield Fault(
            UNMATCHED,
            (node.name,),
            str(rule),
            f'The rule {rule} matches no name of {node.name}, which has '
            f'{names}.{f" The nearest is {near}." if near else ""}',
            aloud=alone or bool(near),
        )


def _own_names(node: OwnNode) -> set[str]:
    """Return the names of a node that not every node has."""
    usual = {f'{node.name}/{service}' for service in EVERY_NODE_OFFERS}
    return set(node.ends()) - usual - set(EVERY_NODE_HAS)


def _full(name: str, node: OwnNode) -> str:
    """Return the full name of a topic in a rule for a node."""
    name = re.sub('^(rostopic|rosservice)://', '', name)
    if name.startswith('/'):
        return name
    space = node.name if name.startswith('~') else node.namespace.rstrip('/')
    return f'{space}/{name.lstrip("~/")}'


def _last(name: str) -> str:
    return name.rpartition('/')[2]
