"""Exercise: a program in a file that stops the robot when Ctrl-C ends it."""

from __future__ import annotations

import signal
from functools import partial
from pathlib import Path

from labkit.exercises import Exercise, Fail, Probe, Solution, expect, words_of
from labkit.exercises.clauses import (
    Asked,
    Evidence,
    Messages,
    Publishes,
    Stream,
    often,
)
from labkit.exercises.figures import figure
from labkit.exercises.history import Note
from labkit.exercises.messages_heard import Sample
from labkit.exercises.observation import live
from labkit.exercises.variants import varied
from labkit.lessons._terminal import RunsFile
from labkit.lessons.turtlebot.drive import SAME, TWIST, command_of

__all__ = ['exercise']

WORDS = words_of(__file__)

NODE = '/cruiser'
RUNS = RunsFile('nodes/cruiser.py', [NODE])
SPEED, HZ = 0.1, 10.0
# Those of the variants, besides, Hz.
RATES = (4.0, 5.0, 8.0)
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
    process = RUNS.process(evidence)
    is_lottery = _ends_ros_first(process.pid)
    watch = expect.ends_with_node(probe, source, partial(process.send_signal, signal.SIGINT))
    probe.wait(lambda: command_of(watch.samples[-1]).stops, LATE_SEC)
    last = command_of(watch.samples[-1])
    if is_lottery:
        raise Fail(
            'a program whose last command always says stop',
            f'the last command says {last}; and rclpy.init() has put a handler of its own in '
            'the place of that for Ctrl-C',
            HANDLERS,
        )
    _refuse_others(probe)
    if not last.stops:
        expected = 'a last command with all numbers 0.0'
        raise Fail(expected, f'the last command says {last}', NO_STOP)
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


def _ends_ros_first(pid: int) -> bool:
    """Tell whether a process has the signal handlers of rclpy.

    rclpy has one for SIGTERM, too. Python by itself has none: so that one tells. Source: rclpy,
    src/rclpy/signal_handler.cpp; where there is no /proc, it is not known.
    """
    status = Path(f'/proc/{pid}/status')
    if not status.exists():
        return False
    lines = dict(line.split(':', 1) for line in status.read_text().splitlines())
    return bool(int(lines['SigCgt'], 16) & 1 << signal.SIGTERM - 1)


def _variant(*, speed: float = SPEED, hz: float = HZ) -> Exercise:
    rate = WORDS.of(rate=often(hz).partition(' (')[0]).clause('rate')
    words = WORDS.of(speed=speed, rate=rate if (speed, hz) != (SPEED, HZ) else '')
    return Exercise(
        words=words,
        shared=['/cmd_vel'],
        reliable=['/cmd_vel'],
        once=True,
        clauses=(
            RUNS,
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
    # Times of another process are known to a step, so a long while tells the rate.
    samples = live(probe, {'/cmd_vel': TWIST}, 10.0, nodes=[NODE]).on('/cmd_vel')
    if len(samples) < 3 or samples[-1].at == samples[0].at:
        return None
    seen = (len(samples) - 1) / (samples[-1].at - samples[0].at)
    hz = min((HZ, *RATES), key=lambda each: abs(each - seen))
    return {'speed': round(samples[-1].message.linear.x, 6), 'hz': hz}


exercise = varied(
    _variant(),
    _variant,
    _guess,
    speed=[centimetres / 100 for centimetres in (5, 6, 7, 8, 9, *range(11, 22))],
    hz=RATES,
)
