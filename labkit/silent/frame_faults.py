"""Frames: names that nobody publishes, several parents, loops, trees apart, other clocks.

What other processes publish is known as long as a transform listener of this process hears it.
Without one, frames are known only if all who publish them are of this process.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from operator import attrgetter
from typing import TYPE_CHECKING

from labkit.errors import did_you_mean, first_few
from labkit.silent.broadcasts import COUNTS_SEC, MOVING, STATIC
from labkit.silent.kinds import Fault, kind
from labkit.silent.scene import Broadcast, Listening, OwnNode, Publisher, Scene
from labkit.silent.timing_faults import FUTURE, OFF_SEC

if TYPE_CHECKING:
    from labkit.transforms.tree import Edge

__all__ = ['look_at_frames']

_OTHERS = 'tf2 raises an exception, or logs, where the frame is needed'

UNKNOWN = kind(
    'frames.unknown',
    'tf2 does not know the frame: nobody publishes where it is',
    'Publish where it is in its parent: with a StaticTransformBroadcaster or a '
    'static_transform_publisher if it does not move. `ros2 run tf2_tools view_frames` shows all '
    'frames.',
    'nobody publishes transforms, or other processes do and no TransformListener of the notebook '
    'hears them; if a cell asks, which gets the error itself',
    others=_OTHERS,
)
TWO_PARENTS = kind(
    'frames.two-parents',
    'A frame jumps: it has two parents',
    'A frame has one parent. Leave one of the two away, or give it another name.',
    'the parent changes once, as that of a thing does which a robot picks up',
)
TWO_SOURCES = kind(
    'frames.two-publishers',
    'A frame jumps: two publishers say where it is',
    'Let one of them alone publish this transform: of a robot with a filter, the filter and not '
    'the driver (often a parameter, publish_tf).',
    'one takes over from the other, or both say the same on /tf_static; the two are not in the '
    'notebook',
)
LOOP = kind(
    'frames.loop',
    'Lookups fail: the tree of frames has a loop',
    'Each frame is in its parent, and the parent is nearer to the root. Swap header.frame_id, the '
    'parent, and child_frame_id where they are the wrong way round.',
    'there is a root',
    others=_OTHERS,
)
APART = kind(
    'frames.apart',
    'Two frames are not connected: there are two trees',
    'Publish where the root of one tree is in a frame of the other one.',
    'nobody asks, and each tree has a prefix of its own, as robots of a fleet have',
    others=_OTHERS,
)
CLOCK = kind(
    'frames.clock',
    'Each lookup would need extrapolation: transforms have the time of another clock',
    'Set use_sim_time for all nodes or for none. A bag has the time at which it was recorded: '
    'play it with --clock, and set use_sim_time for those who listen.',
    'they are less than ten seconds old, or no new ones come',
    others=_OTHERS,
)
ONCE = kind(
    'frames.once',
    'A frame is lost after a while: where it is was sent once, on /tf',
    'What does not move belongs on /tf_static: use a StaticTransformBroadcaster. What moves is '
    'sent again and again, with the time of now.',
    'it is sent again, even if it stays the same',
    guess='it may be meant for that moment',
    aloud=False,
)
STATIC_MOVES = kind(
    'frames.static-moves',
    'A moving frame on /tf_static: where it was before is forgotten',
    'Use a TransformBroadcaster, which publishes on /tf: with the times, tf2 finds where the '
    'frame was when a message was recorded.',
    'it is sent again with the same numbers, or moved by hand now and then',
)

# On this topic a simulator tells where things are in its own world.
_TRUTH = 'base_pose_ground_truth'
# Behind its clock by more than that is what a buffer has forgotten, s.
_OLD_SEC = 10.0
# An innocent reason is over by then, s: whoever listens has heard nothing yet.
_PATIENCE_SEC = 2.0
_ONCE_SEC = 5.0
# So many changes of a parent, or of the place of a static frame, are no accident.
_CHANGES, _STATIC_CHANGES = 3, 5
# More time than that between two of them is somebody who tries a place, s.
_BY_HAND_SEC = 2.0


@dataclass(frozen=True)
class _Said:
    """A transform that counts now, and who publishes it."""

    node: str
    topic: str
    sent: Broadcast

    @property
    def is_static(self) -> bool:
        return self.topic == STATIC


@dataclass(frozen=True)
class _Tree:
    """What is known of all frames: by a listener, or since all of it comes from this process."""

    parents: Mapping[str, str]
    names: frozenset[str]
    listener: Listening | None = None

    def root(self, frame: str) -> str:
        """Return the root above a frame, '' if a loop is above it."""
        seen = {frame}
        while (parent := self.parents.get(frame, '')) and parent not in seen:
            seen.add(parent)
            frame = parent
        return '' if parent else frame


def look_at_frames(scene: Scene) -> Iterator[Fault]:
    """Find what is wrong with the frames that are published, heard or asked for."""
    said: set[str] = set()
    for fault in _found(scene):
        if str(fault) in said:
            continue  # two listeners hear the same
        said.add(str(fault))
        topic = STATIC if fault.kind is STATIC_MOVES else MOVING
        # One that is about a topic is shown there.
        yield fault if fault.about.startswith('/') else replace(fault, topic=topic)


def _found(scene: Scene) -> Iterator[Fault]:
    yield from _habits(scene)
    said = [
        _Said(node.name, pub.topic, sent)
        for node, pub in _publishers(scene)
        for sent in pub.broadcasts
        if sent.parent and sent.child and _counts(scene, pub, sent)
    ]
    if not said and not scene.listeners:
        return
    jumping = list(_jumps(scene, said))
    yield from jumping
    yield from _jumps_heard(scene, {fault.about for fault in jumping})
    trees = list(_trees(scene))
    for tree in trees:
        yield from _loops(scene, tree, said)
        yield from _apart(scene, tree, said)
    yield from _unknown(scene, trees)
    yield from _clocks(scene, {each.sent.child for each in said})


def _publishers(scene: Scene) -> Iterator[tuple[OwnNode, Publisher]]:
    # In an order that is the same at the next look, for whoever says what of a frame.
    for node in sorted(scene.nodes, key=attrgetter('name')):
        for pub in sorted(node.publishers, key=attrgetter('topic')):
            if pub.topic in (MOVING, STATIC):
                yield node, pub


def _counts(scene: Scene, pub: Publisher, sent: Broadcast) -> bool:
    """Return whether a transform counts now: of /tf_static, only the last message does."""
    if pub.topic == STATIC:
        return sent.last == pub.last
    return scene.now - sent.last < COUNTS_SEC


def _trees(scene: Scene) -> Iterator[_Tree]:
    for each in scene.listeners:
        yield _Tree({e.child: e.parent for e in each.edges}, each.names, each)
    if not scene.listeners and _knows_all(scene):
        sent = [sent for _, pub in _publishers(scene) for sent in pub.broadcasts]
        parents = {each.child: each.parent for each in sent}
        if parents:
            yield _Tree(parents, frozenset((*parents, *parents.values())))


def _knows_all(scene: Scene) -> bool:
    """Return whether all who publish frames are of this process, if there are any."""
    own = len(list(_publishers(scene)))
    return bool(own) and own == sum(scene.publishers.get(topic, 0) for topic in (MOVING, STATIC))


# -- two say where a frame is -----------------------------------------------------------------


def _jumps(scene: Scene, said: list[_Said]) -> Iterator[Fault]:
    """Find frames of which publishers of this process say different things."""
    of_child: dict[str, list[_Said]] = {}
    for each in said:
        of_child.setdefault(each.sent.child, []).append(each)
    for child, some in of_child.items():
        for one, two in combinations(some, 2):
            if not _at_once(one, two):
                continue
            nodes = scene.mended_first(one.node, two.node)
            # Of two static ones the last holds for who has heard both: it may be a correction.
            fixed = one.is_static and two.is_static
            what = 'the one that is heard last holds' if fixed else 'it jumps between the two'
            if one.sent.parent != two.sent.parent:
                yield Fault(
                    TWO_PARENTS,
                    nodes,
                    child,
                    f'{one.node} says that {child} is in {one.sent.parent}, and '
                    f'{two.node if two.node != one.node else "also"} that it is in '
                    f'{two.sent.parent}: a frame has one parent, so {what}.',
                    aloud=not fixed,
                )
            elif not (fixed and one.sent.place == two.sent.place):
                who = f'{one.node} and {two.node} both say'
                if one.node == two.node:
                    who = f'Two publishers of {one.node} say'
                yield Fault(
                    TWO_SOURCES,
                    nodes,
                    child,
                    f'{who} where {child} is in {one.sent.parent}: {what}.',
                    aloud=not fixed,
                )
            else:
                continue
            break


def _at_once(one: _Said, two: _Said) -> bool:
    """Return whether two transforms count at a time, and not one after the other."""
    if one.is_static or two.is_static:
        return True
    a, b = one.sent, two.sent
    return a.last > b.first and b.last > a.first and min(a.count, b.count) >= _CHANGES


def _jumps_heard(scene: Scene, told: set[str]) -> Iterator[Fault]:
    """Find frames that have one parent and another in turns, whoever publishes them."""
    for each in scene.listeners:
        for child, moves in each.moves.items():
            recent = [move for move in moves if scene.now - move[0] < COUNTS_SEC]
            if child in told or len(recent) < _CHANGES:
                continue
            _, before, after = recent[-1]
            who = _who_publishes(scene)
            yield Fault(
                TWO_PARENTS,
                scene.mended_first(each.node, *who),
                child,
                f'{each.node} hears that {child} is in {before} and in {after}, in turns: a frame '
                f'has one parent, so it jumps between the two.{_on_topics(who)}',
            )


def _who_publishes(scene: Scene) -> list[str]:
    return [
        end.node
        for topic in scene.graph.topics
        if topic.name in (MOVING, STATIC)
        for end in topic.publishers
    ]


def _on_topics(nodes: list[str]) -> str:
    names = first_few(sorted(set(nodes)))
    return f' On /tf and /tf_static publish: {names}.' if names else ''


# -- the tree -----------------------------------------------------------------------------------


def _loops(scene: Scene, tree: _Tree, said: list[_Said]) -> Iterator[Fault]:
    seen: set[str] = set()
    for start in tree.parents:
        way: list[str] = []
        frame = start
        while frame in tree.parents and frame not in seen:
            seen.add(frame)
            way.append(frame)
            frame = tree.parents[frame]
        if frame not in way:
            continue
        loop = way[way.index(frame) :]
        steps = ', '.join(f'{each} is in {tree.parents[each]}' for each in loop[:5])
        is_kept = tree.listener is not None and any(
            edge.child in loop and _may_be_old(scene, edge, said) for edge in tree.listener.edges
        )
        yield Fault(
            LOOP,
            _menders(scene, tree, () if is_kept else said, set(loop)),
            min(loop),
            f'The frames go round in a loop: {steps}. Lookups with them fail.',
            'It may be mended meanwhile: a Buffer keeps what it has heard. A new one shows it.'
            * is_kept,
            aloud=not is_kept,
        )


def _may_be_old(scene: Scene, edge: Edge, said: Sequence[_Said]) -> bool:
    """Return whether a listener has heard it once, and maybe nobody says so any more."""
    if edge.latest and scene.now - edge.heard > COUNTS_SEC:
        return True
    says_so = {(each.sent.child, each.sent.parent) for each in said}
    # What is fixed is said once, and of other processes nobody knows whether they are still there.
    return (not edge.latest or _knows_all(scene)) and (edge.child, edge.parent) not in says_so


def _menders(
    scene: Scene, tree: _Tree, said: Sequence[_Said], children: set[str]
) -> tuple[str, ...]:
    """Return the nodes that publish frames, or else the one that hears them."""
    nodes = [each.node for each in said if each.sent.child in children]
    listener = [tree.listener.node] if tree.listener is not None else []
    return scene.mended_first(*(nodes or listener))


def _apart(scene: Scene, tree: _Tree, said: list[_Said]) -> Iterator[Fault]:
    """Find trees that nothing connects: aloud if somebody looks from one to the other."""
    roots = {frame: tree.root(frame) for frame in sorted(tree.names)}
    told: set[frozenset[str]] = set()
    asked = tree.listener.asked if tree.listener is not None else {}
    for (target, source), seconds in asked.items():
        a, b = roots.get(target, ''), roots.get(source, '')
        if a and b and a != b and seconds >= _PATIENCE_SEC:
            assert tree.listener is not None
            told.add(frozenset((a, b)))
            yield Fault(
                APART,
                (tree.listener.node,),
                f'{source} in {target}',
                f'{tree.listener.node} asks where {source} is in {target}, but nothing connects '
                f'them: {source} is in the tree of {b}, {target} in that of {a}.',
                _how_to_connect(roots, a, b),
            )
    tops = sorted({root for root in roots.values() if root})
    if len({top.rpartition('/')[0] for top in tops}) == len(tops):
        return  # one, or each robot has its prefix
    first, *rest = tops
    for other in rest:
        if frozenset((first, other)) not in told:
            children = {child for child, parent in tree.parents.items() if parent == other}
            yield Fault(
                APART,
                _menders(scene, tree, said, children),
                other,
                f'Nothing connects the tree of {other} with that of {first}.',
                _how_to_connect(roots, first, other),
                aloud=False,
            )


def _how_to_connect(roots: Mapping[str, str], one: str, two: str) -> str:
    """Return what to do; '' unless a root is nearly the name of a frame of the other tree."""
    for root in (one, two):
        near = did_you_mean(root, [frame for frame, top in roots.items() if top != root])
        if near:
            return f'{near} Nobody says where {root} is.'
    return ''


def _unknown(scene: Scene, trees: list[_Tree]) -> Iterator[Fault]:
    """Find names of frames that nobody publishes: asked for, or in the header of messages."""
    there = any(scene.publishers.get(topic) for topic in (MOVING, STATIC))
    for each in scene.listeners:
        if there and not each.names:
            continue  # nothing was heard yet
        wanted = {name: sec for pair, sec in each.asked.items() for name in pair}
        for name, seconds in wanted.items():
            if name and name not in each.names and seconds >= _PATIENCE_SEC:
                yield Fault(
                    UNKNOWN,
                    (each.node,),
                    name,
                    f'{each.node} asks for the frame {name}, which nobody publishes.'
                    + ' Nobody publishes on /tf or /tf_static at all.' * (not there),
                    did_you_mean(name, sorted(each.names)),
                )
    known = {name for tree in trees for name in tree.names}
    if not known:
        return
    for node in scene.nodes:
        for pub in node.publishers:
            frame = pub.frame
            # A slash in front has a kind of its own. The world of a simulator need not be a frame.
            told = frame.startswith('/') or pub.topic.endswith(_TRUTH)
            if frame and frame not in known and not told:
                yield Fault(
                    UNKNOWN,
                    (node.name,),
                    pub.topic,
                    f'{node.name} publishes on {pub.topic} in the frame {frame}, but nobody '
                    'publishes where that is.',
                    did_you_mean(frame, sorted(known)),
                )


# -- times --------------------------------------------------------------------------------------


def _clocks(scene: Scene, own: set[str]) -> Iterator[Fault]:
    """Find transforms of other processes with times that are not those of the listener."""
    for each in scene.listeners:
        node = scene.own(each.node)
        if node is None or not node.now:
            continue
        for edge in each.edges:
            ahead = (edge.latest - node.now) * 1e-9
            if not edge.latest or edge.child in own or scene.now - edge.heard > COUNTS_SEC:
                continue
            if edge.heard < scene.since:  # while a check had a time of its own
                continue
            who = _who_publishes(scene)
            nodes = scene.mended_first(each.node, *who)
            what = f'{each.node} hears where {edge.child} is in {edge.parent}'
            if OFF_SEC < ahead < _OLD_SEC:
                text = f'{what}, {ahead:.3g} s ahead of its clock.{_on_topics(who)}'
                yield Fault(
                    FUTURE,
                    nodes,
                    edge.child,
                    text,
                    'Set the clocks of the two computers: both by NTP.',
                )
            elif abs(ahead) > _OLD_SEC:
                yield Fault(
                    CLOCK,
                    nodes,
                    '/tf',
                    f'{what} at {edge.latest * 1e-9:.0f} s, but its clock says '
                    f'{node.now * 1e-9:.0f} s.{_on_topics(who)}',
                )
                break


def _habits(scene: Scene) -> Iterator[Fault]:
    """Find frames on the wrong one of the two topics."""
    for node, pub in _publishers(scene):
        for sent in pub.broadcasts:
            quiet = scene.now - sent.last
            if pub.topic == MOVING and sent.count == 1 and quiet > _ONCE_SEC:
                yield Fault(
                    ONCE,
                    (node.name,),
                    sent.child,
                    f'{node.name} has sent once on /tf where {sent.child} is in {sent.parent}, '
                    f'{quiet:.0f} s ago: whoever comes later does not know it, and nobody knows '
                    'where it is now.',
                )
            often = sent.changes >= _STATIC_CHANGES and quiet < COUNTS_SEC
            by_hand = sent.last - sent.first > _BY_HAND_SEC * sent.changes
            if pub.topic == STATIC and often and not by_hand:
                yield Fault(
                    STATIC_MOVES,
                    (node.name,),
                    sent.child,
                    f'{node.name} says on /tf_static where {sent.child} is in {sent.parent}, '
                    f'which has changed {sent.changes} times.',
                )
