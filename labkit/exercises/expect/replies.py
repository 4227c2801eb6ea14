"""Send test messages to the learner's node, and see what it answers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises.expect.timing import hanging, spun
from labkit.exercises.expect.values import show, text_trouble
from labkit.exercises.probe import Probe
from labkit.exercises.verdict import Fail
from labkit.exercises.watch import Sample, Watch

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['Reply', 'lines_of', 'logs', 'replies']

# How long an answer may take; asked again after this it is looked at what the node is busy with.
PATIENCE_SEC = 0.6
WITHIN_SEC = 1.5
# Once something came, the right answer is not far behind.
AFTER_SEC = 0.25
# An answer of another process is lost if that process does not know of the listener yet, and
# nothing tells when it does. So an unanswered message is sent again.
ATTEMPTS = 2

Explain = Callable[[Mapping[str, Any], list[Any]], tuple[str, str]]


@dataclass(frozen=True)
class Reply:
    """What came back for one test message.

    Attributes:
        sent: The fields of the test message.
        values: What the answers had in the field that was looked at, in their order.
        delay: Seconds from sending to the right answer.
    """

    sent: Mapping[str, Any]
    values: list[Any]
    delay: float


def replies(
    probe: Probe,
    source: Endpoint,
    sent: Sequence[Mapping[str, Any]],
    answer: Endpoint,
    wanted: Callable[[Mapping[str, Any]], Any],
    *,
    field: str = 'data',
    explain: Explain | None = None,
) -> list[Reply]:
    """Send test messages one by one, and expect the right answer to each.

    Other nodes may publish on both topics meanwhile, so use values that nobody else would send;
    what else comes is not judged.

    Args:
        probe: The probe of the check.
        source: The subscription that gets the test messages, as `subscription` returned it.
        sent: The fields of each test message, such as `{'data': 41}`.
        answer: The publisher of the answers, as `publisher` returned it.
        wanted: What the answer to a test message has in `field`.
        field: Name of the field of the answer that is looked at.
        explain: Called with the test message and the values that came instead (maybe none);
            returns the misconception and the next step, or two empty texts.

    Returns:
        The answers.

    Raises:
        Fail: An answer is wrong, or does not come.
    """
    watch = probe.watch(answer.topic, answer.msg_type)
    send = probe.sender(source.topic, source.msg_type)
    results = []
    for fields in sent:
        before = len(watch)
        right = wanted(fields)

        def came(start: int = before) -> list[Any]:
            return watch.values(field)[start:]

        for _ in range(1 if probe.in_this_process(source) else ATTEMPTS):
            sent_at = send(fields)
            if _arrives(probe, watch, before, lambda: right in came()) or came():  # noqa: B023
                break
            spun(probe, source)
        if right not in came():
            _refuse(source, answer, fields, right, came(), field, explain)
        position = before + came().index(right)
        delay = watch.samples[position].stamp - sent_at
        results.append(Reply(fields, came(), delay))
    return results


def lines_of(node: str, samples: Iterable[Sample]) -> list[tuple[float, str]]:
    """Return the lines of a node's logger and of the loggers below it, with their times `at`.

    Args:
        node: Full name of the node.
        samples: Messages of /rosout.
    """
    logger = node.strip('/').replace('/', '.')
    return [
        (sample.at, sample.message.msg)
        for sample in samples
        if sample.message.name == logger or sample.message.name.startswith(f'{logger}.')
    ]


def logs(probe: Probe, node: str, source: Endpoint, fields: Mapping[str, Any], text: str) -> str:
    """Send a test message, and expect that the node logs it.

    Args:
        probe: The probe of the check.
        node: Full name of the node that must log.
        source: Its subscription.
        fields: The fields of the test message.
        text: What must be part of the logged line.

    Returns:
        The line.

    Raises:
        Fail: Nothing is logged, or something else.
    """
    before = len(probe.logs)
    send = probe.sender(source.topic, source.msg_type)

    def lines() -> list[str]:
        return [line for _, line in lines_of(node, probe.logs.samples[before:])]

    def logged() -> bool:
        return any(text in line for line in lines())

    for _ in range(1 if probe.in_this_process(source) else ATTEMPTS):
        send(fields)
        if _arrives(probe, probe.logs, before, logged) or lines():
            break
        spun(probe, source)
    if not logged():
        raise Fail(
            f'{node} logs a line with {text!r} when {_show(fields)} comes on {source.topic}',
            f'{node} logged {show(lines())}' if lines() else f'{node} logged nothing',
            why='The callback runs, but its line does not hold what the message says.'
            if lines()
            else 'The callback does not log. print() shows a text here; the logger also tells '
            'all other nodes of it.',
            todo="In the callback: self.get_logger().info(f'...{msg.data}')",
        )
    return next(line for line in lines() if text in line)


def _arrives(probe: Probe, watch: Watch, before: int, right: Callable[[], bool]) -> bool:
    """Wait for the right answer, shortly if wrong ones came, and not at all if nothing can."""
    if probe.wait(lambda: right() or len(watch) > before, PATIENCE_SEC):
        return probe.wait(right, AFTER_SEC)
    hanging(probe)
    return probe.wait(right, WITHIN_SEC - PATIENCE_SEC)


def _refuse(
    source: Endpoint,
    answer: Endpoint,
    fields: Mapping[str, Any],
    right: Any,
    came: list[Any],
    field: str,
    explain: Explain | None,
) -> NoReturn:
    why, todo = explain(fields, came) if explain is not None else ('', '')
    if not why:
        why, todo = _usual_reason(source, answer, right, came)
    raise Fail(
        f'{field} = {right!r} on {answer.topic} when {_show(fields)} comes on {source.topic}',
        f'{field} = {show(came)}' if came else f'nothing on {answer.topic}',
        why=why,
        todo=todo,
    )


def _usual_reason(
    source: Endpoint, answer: Endpoint, right: Any, came: list[Any]
) -> tuple[str, str]:
    if not came:
        return (
            f'The message reached {source.node}, but its callback did not publish.',
            f'Publish on {answer.topic} in the callback of the subscription to {source.topic}.',
        )
    return text_trouble(came[-1], right), 'Compare the value that is wanted with the one seen.'


def _show(fields: Mapping[str, Any]) -> str:
    return ', '.join(f'{name} = {value!r}' for name, value in fields.items())
