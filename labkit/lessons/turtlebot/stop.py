"""Exercise: stop the robot, whatever ends the node."""

from __future__ import annotations

import signal
from functools import partial
from pathlib import Path

from labkit.exercises import Exercise, Fail, Probe, Solution, expect, words_of
from labkit.exercises.clauses import (
    Asked,
    Evidence,
    Messages,
    Named,
    Publishes,
    Stream,
    often,
)
from labkit.exercises.figures import figure
from labkit.exercises.history import Note
from labkit.exercises.messages_heard import Sample
from labkit.exercises.observation import live
from labkit.exercises.variants import varied
from labkit.lessons.turtlebot.drive import SAME, TWIST, command_of

__all__ = ['exercise']

WORDS = words_of(__file__)

NODE = '/cruiser'
SPEED, HZ = 0.1, 10.0
# How long the last command of another process may be on its way, s.
LATE_SEC = 0.3
# How much time passes for another node, to see whether it goes on, s: it sends ten commands a
# second.
GOES_ON_SEC = 0.5

OTHER_SPEED = WORDS.mistake('stop/other-speed')
STANDS = WORDS.mistake('stop/stands')
TURNS = WORDS.mistake('stop/turns')
HANDLERS = WORDS.mistake('stop/handlers')
NO_STOP = WORDS.mistake('stop/no-stop')
ANOTHER = WORDS.mistake('stop/another')


def _cruises(stream: Stream, wanted: float) -> None:
    sent: list[Sample | Note] = [*stream.earlier, *stream.samples]
    for number, sample in enumerate(sent, start=1):
        command = command_of(sample)
        turns = command.w or command.others
        if abs(command.v - wanted) < SAME and not turns:
            continue
        raise Fail(
            f'linear.x = {wanted} m/s and 0.0 in all other numbers, while the node runs',
            f'command {number} says {command}',
            (STANDS if command.stops else TURNS if turns else OTHER_SPEED).of(wanted=wanted),
        )


def _says_stop(evidence: Evidence) -> str:
    probe = evidence.probe
    source = evidence.publisher('/cmd_vel', NODE)
    is_script = not probe.in_this_process(source)
    is_lottery = is_script and _ends_ros_first(source.gid)
    watch = expect.ends_with_node(probe, source)
    probe.wait(lambda: command_of(watch.samples[-1]).stops, LATE_SEC)
    last = command_of(watch.samples[-1])
    if is_lottery:
        raise Fail(
            'a script whose last command always says stop',
            f'the last command says {last}; and rclpy.init() has put a handler of its own in '
            'the place of that for Ctrl-C',
            HANDLERS,
        )
    _refuse_others(probe)
    if not last.stops:
        mistake = NO_STOP
        if is_script:
            mistake = NO_STOP.then(
                'In finally: publish an empty Twist(), then wait until it is there: '
                'publisher.wait_for_all_acked()'
            )
        expected = 'a last command with all numbers 0.0'
        raise Fail(expected, f'the last command says {last}', mistake)
    return 'The last command says stop.'


def _refuse_others(probe: Probe) -> None:
    """Raise Fail if another node of the learner's drives the robot on."""
    names = sorted({end.node for end in probe.publishers('/cmd_vel')})
    if not names:
        return
    life = live(probe, {'/cmd_vel': TWIST}, GOES_ON_SEC, nodes=names)
    if any(not command_of(sample).stops for sample in life.on('/cmd_vel')):
        seen = f'more commands, and {", ".join(names)} publishes on /cmd_vel, too'
        raise Fail(f'no commands when {NODE} has ended', seen, ANOTHER.of(name=names[0]))


def _ends_ros_first(gid: bytes) -> bool:
    """Tell whether the process of an endpoint has the signal handlers of rclpy.

    rclpy has one for SIGTERM, too. Python by itself has none: so that one tells. Source: rclpy,
    src/rclpy/signal_handler.cpp; where there is no /proc, it is not known.
    """
    import psutil  # type: ignore[import-untyped]

    from labkit.rosgraph.whose import process_id

    for child in psutil.Process().children(recursive=True):
        status = Path(f'/proc/{child.pid}/status')
        if child.pid & 0xFFFF == process_id(gid) and status.exists():
            lines = dict(line.split(':', 1) for line in status.read_text().splitlines())
            return bool(int(lines['SigCgt'], 16) & 1 << signal.SIGTERM - 1)
    return False


def _variant(*, speed: float = SPEED, hz: float = HZ) -> Exercise:
    rate = WORDS.of(rate=often(hz).partition(' (')[0]).clause('rate')
    words = WORDS.of(speed=speed, rate=rate if (speed, hz) != (SPEED, HZ) else '')
    return Exercise(
        words=words,
        shared=['/cmd_vel'],
        reliable=['/cmd_vel'],
        once=True,
        clauses=(
            Named(NODE),
            Publishes('/cmd_vel', hz, TWIST, by=NODE),
            Messages(
                '/cmd_vel', words.clause('cruises'), partial(_cruises, wanted=speed), by=NODE
            ),
            Asked(words.clause('says-stop'), _says_stop),
        ),
        answer=Solution.of(words).changed(
            ('create_timer(0.1,', f'create_timer({figure(1 / hz)},'),
            ('msg.linear.x = 0.1', f'msg.linear.x = {speed}'),
        ),
    )


def _guess(probe: Probe) -> dict[str, float] | None:
    expect.publisher(probe, '/cmd_vel', by=NODE)
    samples = live(probe, {'/cmd_vel': TWIST}, 2.0, nodes=[NODE]).on('/cmd_vel')
    if len(samples) < 3 or samples[2].at == samples[1].at:
        return None
    hz = 1 / (samples[2].at - samples[1].at)
    return {'speed': round(samples[-1].message.linear.x, 6), 'hz': round(hz, 3)}


exercise = varied(
    _variant(),
    _variant,
    _guess,
    speed=[centimetres / 100 for centimetres in (5, 6, 7, 8, 9, *range(11, 22))],
    hz=(4.0, 5.0, 8.0),
)
