"""Find a stage of a pipeline: a node that hears one topic and publishes on another one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from labkit.exercises import Probe, expect

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['find_stage']

# How long the first answer of a stage may take, if it makes its publisher only then.
FIRST_ANSWER_SEC = 0.6


def find_stage(
    probe: Probe, inner: str, outer: str, test: Mapping[str, Any]
) -> tuple[Endpoint, Endpoint]:
    """Expect a node of the learner's that subscribes to one topic and publishes on another one.

    Args:
        probe: The probe of the check.
        inner: Full name of the topic that it hears.
        outer: Full name of the topic that it publishes on.
        test: Fields of a message to send, should the node not have a publisher yet.

    Returns:
        Its subscription and its publisher.

    Raises:
        NotAttempted: Nothing of the learner's is there.
        Fail: One of the two is missing, misnamed, of another type, or not the only one.
    """
    found = probe.publishers(outer)
    by = expect.publisher(probe, outer).node if found else ''
    hears = expect.subscription(probe, inner, by=by)
    echoes = {endpoint.node for endpoint in probe.publishers(inner)}
    if not found and hears.node not in echoes:
        probe.sender(inner, hears.msg_type)(test)
        probe.wait(lambda: probe.publishers(outer), FIRST_ANSWER_SEC)
    return hears, expect.publisher(probe, outer, by=hears.node)
