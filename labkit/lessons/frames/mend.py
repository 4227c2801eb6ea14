"""Exercise: find the frame of an arm that is sent wrongly, and send it rightly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from labkit.exercises import Exercise, Fail, Mistake, NotAttempted, expect, words_of
from labkit.exercises.clauses import Evidence, GraphClause, Named
from labkit.exercises.expect.spinning import runs
from labkit.lessons.frames.arm import SHEET, Fault, fault, place_of
from labkit.lessons.frames.mount import NODE as SONAR
from labkit.lessons.frames.mount import SAME_M, SAME_RAD, TOPIC, Static, static_messages
from labkit.lessons.frames.places import Place, degrees, metres

__all__ = ['exercise']

WORDS = words_of(__file__)

NODE = '/mender'

NONE = WORDS.mistake('mend/none')
ALL = WORDS.mistake('mend/all')
ANOTHER = WORDS.mistake('mend/another')
PARENT = WORDS.mistake('mend/parent')
NUMBERS = WORDS.mistake('mend/numbers')
INVERTED = WORDS.mistake('mend/inverted')
AS_IT_WAS = WORDS.mistake('mend/as-it-was')
LENGTH = WORDS.mistake('mend/length')


@dataclass(frozen=True)
class _Mender(Named):
    """There is the node. That of the first exercise, which publishes there, too, is no attempt."""

    def find(self, evidence: Evidence) -> None:
        """Look for the node."""
        probe = evidence.probe

        def attempts() -> set[str]:
            others = {end.node for end in probe.publishers(TOPIC)} - {SONAR}
            return others | ({self.node} & {*probe.node_names()})

        if not probe.wait_to_appear(attempts):
            raise NotAttempted
        super().find(evidence)


@dataclass(frozen=True)
class _Mends(GraphClause):
    """The one frame is sent as the data sheet has it, and no other one."""

    text = WORDS.clause('mends')
    own_life = True

    def find(self, evidence: Evidence) -> None:
        """Look whether there is an arm."""
        if fault() is None:
            raise NotAttempted('There is no arm yet. Run the cell with build_arm() first.')

    def judge(self, evidence: Evidence) -> str:
        """Look at what was sent beside what the arm sends."""
        from labkit.asking.service_calls import wait_until_spun

        drawn = fault()
        assert drawn is not None

        def is_mended(found: list[Any]) -> bool:
            return any(_mended(message, drawn) for message in found)

        messages = static_messages(evidence, is_mended)
        # It may be about to send more: it has when it answers.
        probe = evidence.probe
        if is_mended(messages) and runs(probe, NODE):
            with probe.uncounted():
                wait_until_spun(probe.spun_node, NODE)
            messages += static_messages(evidence, is_mended)
        mended = [found for message in messages for found in _mended(message, drawn)]
        expected = f'a transform of the frame that is wrong, from its parent, on {TOPIC}'
        if not mended:
            evidence.refuse_old_errors()
            expect.spun(probe, evidence.publisher(TOPIC, NODE))
            raise Fail(expected, 'only what the arm sends', NONE)
        frames = sorted({found.child_frame_id for found in mended})
        if len(frames) > 1:
            raise Fail('one frame', f'{len(frames)} of them: {", ".join(frames)}', ALL)
        if frames != [drawn.frame]:
            raise Fail(expected, f'{frames[0]}, which was right', ANOTHER.of(frame=frames[0]))
        found, sent = mended[-1], Place.of(mended[-1].transform)
        if found.header.frame_id == drawn.parent and _same(sent, drawn.place):
            raise Fail(expected, f'{drawn.frame} as the arm sends it', AS_IT_WAS)
        parent = SHEET[drawn.frame][0]
        if found.header.frame_id != parent:
            seen = f'{drawn.frame} in {found.header.frame_id!r}'
            raise Fail(f'{drawn.frame} in {parent}', seen, PARENT)
        right = place_of(drawn.frame)
        if not _same(sent, right) or not sent.is_rotation:
            raise Fail(
                f'{drawn.frame} at {metres(right.shift)}; {degrees(right.turn)}',
                f'{metres(sent.shift)}; {degrees(sent.turn)}',
                _why(sent, right),
            )
        return f'{drawn.frame} was wrong ({_KINDS[drawn.kind]}), and you found it.'


_KINDS = {
    'parent': 'another parent',
    'degrees': 'degrees for radians',
    'inverted': 'the numbers of the way back',
    'mirrored': 'turned to the other side',
}


def _same(one: Place, other: Place) -> bool:
    return one.away(other) <= SAME_M and one.turned(other) <= SAME_RAD


def _why(place: Place, right: Place) -> Mistake:
    if not place.is_rotation:
        return LENGTH
    return INVERTED if _same(place, right.back) else NUMBERS


def _mended(message: Any, drawn: Fault) -> list[Any]:
    """Return the transforms of the arm's frames in a message, unless that is the arm's own."""
    found = [each for each in message.transforms if each.child_frame_id in SHEET]
    for each in found:
        place = Place.of(each.transform)
        names = each.child_frame_id, each.header.frame_id
        is_arm = names == (drawn.frame, drawn.parent) and len(found) == len(SHEET)
        if is_arm and _same(place, drawn.place):
            return []
    return found


exercise = Exercise(
    words=WORDS,
    clauses=(_Mender(NODE), Static(WORDS.of(topic=TOPIC).clause('static'), NODE), _Mends()),
    shared=(TOPIC,),
)
