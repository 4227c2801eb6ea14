"""Exercise: find the node that publishes the wrong type."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Mistake, NotAttempted, words_of
from labkit.exercises.clauses import Evidence, GraphClause, Publishes
from labkit.exercises.expect import show
from labkit.lessons.odds.stadium import GATES, VISITORS, wrong_gates

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, STRING = '/wrong_gate', 'std_msgs/msg/String'

SEVERAL = WORDS.mistake('find-gate/several')
IN_ORDER = WORDS.mistake('find-gate/in-order')
ALTERED = WORDS.mistake('find-gate/altered')
TYPE = WORDS.mistake('find-gate/type')
A_TOPIC = WORDS.mistake('find-gate/topic')
EMPTY = WORDS.mistake('find-gate/empty')
NO_GATE = WORDS.mistake('find-gate/no-gate')


class _NamesTheGate(GraphClause):
    """Each message is the name of the gate that differs from the others."""

    text = WORDS.clause('names-the-gate')

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
    words=WORDS,
    clauses=(Publishes(TOPIC, 1.0, STRING, at_least=True), _NamesTheGate()),
)
