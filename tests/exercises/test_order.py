"""A judge may use matchers in any order: none affects another."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Mapping
from itertools import permutations
from types import ModuleType
from typing import Any

import pytest
from by_hand import ByHand
from rclpy.node import Node
from std_msgs.msg import Int16, String

from labkit.exercises import Exercise, Lesson, Outcome, Probe, Solution, expect

INT16 = 'std_msgs/msg/Int16'
MATCHERS: dict[str, Callable[[Probe], object]] = {
    'publisher': lambda probe: expect.publisher(probe, '/evens'),
    'subscription': lambda probe: expect.subscription(probe, '/odds'),
    'node': lambda probe: expect.node(probe, '/evens'),
}
Graph = tuple[Callable[[], list[Node]], Outcome]


def node(name: str, *, says: str = '', hears: str = '', msg_type: type = Int16) -> Node:
    made = Node(name)
    if says:
        made.create_publisher(msg_type, says, 10)
    if hears:
        made.create_subscription(msg_type, hears, lambda message: None, 10)
    return made


# What is there, and what a check says of it whose exercise asks for a node /evens that publishes
# on /evens and subscribes to /odds. An earlier exercise asks for a publisher on /odds.
GRAPHS: dict[str, Graph] = {
    'nothing': (lambda: [], Outcome.NOT_ATTEMPTED),
    'only a publisher': (lambda: [node('evens', says='evens')], Outcome.FAIL),
    'only a subscription': (lambda: [node('evens', hears='odds')], Outcome.FAIL),
    'both': (lambda: [node('evens', says='evens', hears='odds')], Outcome.PASS),
    'both, in two nodes': (
        lambda: [node('evens', says='evens'), node('ears', hears='odds')],
        Outcome.PASS,
    ),
    'a node of that name, and nothing else': (lambda: [node('evens')], Outcome.FAIL),
    'a node of another name': (lambda: [node('maker', says='evens', hears='odds')], Outcome.FAIL),
    'wrong names': (lambda: [node('evenings', says='Evens', hears='ods')], Outcome.FAIL),
    'wrong name of the publisher': (
        lambda: [node('evens', says='Evens', hears='odds')],
        Outcome.FAIL,
    ),
    'wrong name of the subscription': (
        lambda: [node('evens', says='evens', hears='Odds')],
        Outcome.FAIL,
    ),
    'quite another name': (lambda: [node('maker', says='results')], Outcome.FAIL),
    'wrong type': (
        lambda: [node('evens', says='evens', hears='odds', msg_type=String)],
        Outcome.FAIL,
    ),
    'publishes where it listens': (
        lambda: [node('evens', says='odds', hears='odds')],
        Outcome.FAIL,
    ),
    'two publishers': (
        lambda: [node('evens', says='evens', hears='odds'), node('copy', says='evens')],
        Outcome.FAIL,
    ),
    'an unrelated node': (
        lambda: [node('weather', says='rain', hears='sky', msg_type=String)],
        Outcome.FAIL,
    ),
    'a node of an earlier exercise': (
        lambda: [node('odd_source', says='odds')],
        Outcome.NOT_ATTEMPTED,
    ),
}
# The same where an earlier exercise subscribes to /odds, too, and no name is asked for.
LATER: dict[str, Graph] = {
    'only a publisher': (lambda: [node('maker', says='evens')], Outcome.FAIL),
    'only a subscription': (lambda: [node('ears', hears='odds')], Outcome.NOT_ATTEMPTED),
    'a subscription of another type': (
        lambda: [node('ears', hears='odds', msg_type=String)],
        Outcome.NOT_ATTEMPTED,
    ),
    'both': (lambda: [node('maker', says='evens', hears='odds')], Outcome.PASS),
}

SLOW = pytest.mark.slow('six checks of something wrong')
QUICK = ('wrong type', 'only a subscription')


def outcomes(
    earlier: Mapping[str, Any], nodes: Collection[str] = ()
) -> dict[tuple[str, ...], Outcome]:
    """Return the outcome for each order in which a judge may ask for all that is wanted."""
    names = [name for name in MATCHERS if name != 'node' or nodes]
    found = {}
    for order in permutations(names):

        def judge(probe: Probe, order: tuple[str, ...] = order) -> None:
            for name in order:
                MATCHERS[name](probe)

        common: dict[str, Any] = {'task': '.', 'hints': ['.'], 'answer': Solution('', '', '')}
        before = Exercise(name='count_up', stage=ByHand(lambda probe: None), **earlier, **common)
        asked = Exercise(
            name='evens',
            stage=ByHand(judge),
            publishes={'/evens': INT16},
            subscribes={'/odds': INT16},
            nodes=[*nodes],
            **common,
        )
        Lesson('odds', '04_odds.ipynb', exercises=[before, asked])
        found[order] = asked.check().outcome
    return found


@pytest.mark.parametrize(
    'graph',
    [
        pytest.param(name, marks=() if outcome is not Outcome.FAIL or name in QUICK else SLOW)
        for name, (_, outcome) in GRAPHS.items()
    ],
)
def test_order_of_matchers_does_not_matter(lab: ModuleType, graph: str) -> None:
    make, outcome = GRAPHS[graph]
    for made in make():
        lab.spin(made)
    found = outcomes({'publishes': {'/odds': INT16}}, nodes=['/evens'])
    assert found == dict.fromkeys(found, outcome)


@pytest.mark.parametrize('graph', LATER)
def test_nor_where_an_earlier_exercise_has_the_same_topic(lab: ModuleType, graph: str) -> None:
    make, outcome = LATER[graph]
    for made in make():
        lab.spin(made)
    found = outcomes({'publishes': {'/odds': INT16}, 'subscribes': {'/odds': INT16}})
    assert found == dict.fromkeys(found, outcome)


def test_second_publisher_that_comes_late_is_seen_whatever_was_asked(lab: ModuleType) -> None:
    lab.spin(node('evens', says='evens'))

    def judge(probe: Probe) -> None:
        lab.spin(node('copy', says='evens'))

    asked = Exercise(
        name='evens',
        task='.',
        hints=['.'],
        answer=Solution('', '', ''),
        stage=ByHand(judge),
        publishes={'/evens': INT16},
    )
    assert 'Another node publishes on the same topic.' in asked.check().why


def test_error_in_a_node_of_an_earlier_exercise_is_none_of_this_one(
    lab: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    raised = threading.Event()

    class Source(Node):
        def __init__(self) -> None:
            super().__init__('odd_source')
            self.create_publisher(Int16, 'odds', 10)
            self.create_timer(0.01, self.on_timer)

        def on_timer(self) -> None:
            raised.set()
            raise ValueError('none of your business')

    lab.spin(Source())
    lab.spin(node('evens', hears='odds'))
    assert raised.wait(10)
    found = outcomes({'publishes': {'/odds': INT16}})
    assert found == dict.fromkeys(found, Outcome.FAIL)
