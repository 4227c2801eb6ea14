"""Exercise: find the node that publishes the wrong type."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Mistake, NotAttempted, Solution
from labkit.exercises.clauses import Evidence, GraphClause, Publishes
from labkit.exercises.expect import show
from labkit.lessons.odds.stadium import GATES, VISITORS, wrong_gates

__all__ = ['exercise']

TOPIC, STRING = '/wrong_gate', 'std_msgs/msg/String'

_LOOK = f"Look at topic_type in get_publishers_info_by_topic('{VISITORS}')."
_NAME = 'Use info.node_name.'
_NEEDLE = "!= 'std_msgs/msg/Int16'"
SEVERAL = Mistake(
    'find-gate/several',
    'Several gates are named. Only one of them has another type.',
    _LOOK,
    change=[(_NEEDLE, "!= ''")],
)
IN_ORDER = Mistake(
    'find-gate/in-order',
    '{name} publishes Int16, as most gates do.',
    _LOOK,
    change=[
        (_NEEDLE, "== 'std_msgs/msg/Int16'"),
        ('data=info.node_name))', 'data=info.node_name))\n                break'),
    ],
)
ALTERED = Mistake(
    'find-gate/altered',
    'The name of a gate is in it, but not as the graph has it: capital and small letters differ, '
    'and nothing stands beside the name.',
    _NAME,
    change=[('info.node_name', 'info.node_name.title()')],
)
TYPE = Mistake(
    'find-gate/type',
    'That is a type. The name of the node is asked for.',
    _NAME,
    change=[('info.node_name', 'info.topic_type')],
)
A_TOPIC = Mistake(
    'find-gate/topic',
    'That is a topic. The name of the node is asked for.',
    _NAME,
    change=[('info.node_name', "'visitors'")],
)
EMPTY = Mistake(
    'find-gate/empty',
    'The message was published as it was made: its field data is an empty text.',
    'Set the field before you publish.',
)
NO_GATE = Mistake('find-gate/no-gate', 'There is no gate called {name!r}.', _LOOK)


class _NamesTheGate(GraphClause):
    """Each message is the name of the gate that differs from the others."""

    text = (
        'each message is the name of the wrong gate, with or without a slash before it, and '
        'nothing else'
    )

    def find(self, evidence: Evidence) -> None:
        """Look whether there is a gate to be found."""
        if not wrong_gates():
            raise NotAttempted('The stadium is closed. Run the cell with open_stadium() first.')

    def judge(self, evidence: Evidence) -> str:
        """Compare the names."""
        from labkit.rosgraph.names import UNKNOWN_NODE

        gates = wrong_gates()
        rights = {name for gate in gates for name in (gate, gate.lstrip('/'))}
        # What rmw says of a node that the inspector's own process has only half discovered.
        names = [n for n in evidence.streams[TOPIC, ''].values('data') if n != UNKNOWN_NODE]
        wrong = [name for name in names if name not in rights]
        if wrong:
            raise Fail(
                f'on {TOPIC} the name of the one gate whose type is not that of the others, and '
                'nothing else',
                f'data = {show(list(dict.fromkeys(names)))}',
                _mistake(evidence, wrong[0], some=any(name in rights for name in names)),
            )
        return f'{gates[0]} publishes another type on {VISITORS}, and you found it.'


def _mistake(evidence: Evidence, name: str, *, some: bool) -> Mistake:
    """Return what a wrong name shows, beside right ones or alone."""
    gates = [gate.lstrip('/') for gate in GATES]
    if name.lstrip('/') in gates:
        return SEVERAL if some else IN_ORDER.of(name=name)
    if any(gate in name.lower() for gate in gates):
        return ALTERED
    if '/msg/' in name:
        return TYPE
    if f'/{name.lstrip("/")}' in evidence.probe.topics():
        return A_TOPIC
    return NO_GATE.of(name=name) if name else EMPTY


exercise = Exercise(
    name='find_gate',
    task=f'One gate publishes another type on {VISITORS}. Find it, and publish its name as a '
    f'`String` on {TOPIC}, at least once a second.',
    clauses=(Publishes(TOPIC, 1.0, STRING, at_least=True), _NamesTheGate()),
    hints=[
        f'Ask the graph who publishes on {VISITORS}, as the lesson did for /goals.',
        'Each entry of get_publishers_info_by_topic() has a node_name and a topic_type. Print '
        'both, and compare.',
        'Publish the name that you have found: String(data=...). Better: let a loop over the '
        'entries find the one whose topic_type is not std_msgs/msg/Int16.',
    ],
    answer=Solution(
        __file__,
        'find_gate.py',
        'The graph knows the type of every publisher, so a node can look for the odd one by '
        'itself. On a robot such a node can run all the time.',
    ),
)
