"""Exercise: stop in front of a wall, by the laser scan."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.figures import figure
from labkit.lessons.turtlebot.drive import EMPTY, SAME, SCAN, Drive, Trial
from labkit.lessons.turtlebot.drive_clauses import STOPS, Begins, Hears
from labkit.lessons.turtlebot.stage import Drives
from labkit.sim.robots import BURGER

__all__ = ['exercise']

WORDS = words_of(__file__)

SIGN = ('/go_wall', EMPTY)
# The walls of the robot's room stand so far from the origin, m.
WALL = 2.5
# It has to drive so fast, m/s, and to stop if something ahead is nearer than this, m; for how much
# both is right, to stop and to go on, m.
SPEED, NEAR, EITHER = 0.2, 0.5, 1e-3
# Ahead are so many beams on each side.
AHEAD = 10
# The radius of a rod that just one beam meets in the first scan in which it is too near, and in
# the next one neither of the beams beside that, m.
ROD = 0.0035
# The fewest commands a second, and how late the stop command may be, s.
FEWEST_HZ, LATE_SEC = 5, 0.2

RELIABLE = WORDS.mistake('wall/reliable')
BACKWARDS = WORDS.mistake('wall/backwards')
OTHER_SPEED = WORDS.mistake('wall/other-speed')
TURNS = WORDS.mistake('wall/turns')
SAID_ONCE = WORDS.mistake('wall/said-once')
NAN_HIDES = WORDS.mistake('wall/nan-hides')
TOO_NEAR = WORDS.mistake('wall/too-near')
ZERO = WORDS.mistake('wall/zero')
NO_NUMBER = WORDS.mistake('wall/no-number')
BESIDE = WORDS.mistake('wall/beside')
TOO_EARLY = WORDS.mistake('wall/too-early')


class _Scans(Hears):
    @property
    def text(self) -> str:
        return WORDS.of(hears=super().text).clause('best-effort')

    def find(self, seen: Drive) -> None:
        super().find(seen)
        name = seen.evidence.subscription(self.sign).node
        reliability = seen.evidence.subscription(self.topic, name).qos.reliability.name
        if reliability != 'BEST_EFFORT':
            said = f'{name} subscribes with reliability {reliability.lower()}'
            raise Fail('/scan with reliability best_effort', said, RELIABLE)


def _speed(drive: Drive) -> None:
    gaps = drive.gaps
    if len(drive.moving) == 1 and not drive.ending:
        gaps = [math.inf]
    if gaps and max(gaps) > 1.25 / FEWEST_HZ + drive.margin:
        seen = f'{figure(max(gaps))} s from one to the next'
        raise Fail(
            f'a command every {1 / FEWEST_HZ} s, or more often',
            'one command' if len(drive.moving) < 3 else seen,
            SAID_ONCE,
        )
    for command in drive.moving:
        straight = not (command.w or command.others)
        # One that says stop is another clause's affair.
        if command.stops or (abs(command.v - SPEED) < SAME and straight):
            continue
        raise Fail(
            f'linear.x = {SPEED} m/s, and 0.0 in all other numbers',
            f'a command with {command}',
            BACKWARDS if command.v == -SPEED else TURNS if command.w else OTHER_SPEED,
        )


def _stops_in_time(drive: Drive) -> None:
    near = [at for at, scan in drive.scans if at >= drive.sign and _ahead(scan) < NEAR - EITHER]
    stop = drive.ending[0].at if drive.ending else math.inf
    if near and stop > near[0] + LATE_SEC + drive.margin and (drive.ending or drive.cut):
        way = min(_ahead(scan) for at, scan in drive.scans if at <= stop)
        expected = f'it stops within {LATE_SEC} s after the first scan below {NEAR} m ahead'
        seen = next(scan for at, scan in drive.scans if at >= near[0])
        hides = any(math.isnan(other) for other in (*seen[:AHEAD], *seen[-AHEAD:]))
        mistake = NAN_HIDES if hides else TOO_NEAR
        raise Fail(expected, f'the wall came as near as {way:.2f} m', mistake)


def _drives_on(drive: Drive) -> None:
    if not drive.ending:
        return
    heard = [scan for at, scan in drive.scans if at <= drive.ending[0].at + drive.margin]
    if any(_ahead(scan) < NEAR + EITHER for scan in heard):
        return
    last = heard[-1] if heard else [math.inf]
    ahead = _ahead(last)
    mistake = TOO_EARLY
    if min((way for way in last if way > 0), default=math.inf) < NEAR:
        mistake = BESIDE
    elif last[0] == 0.0:
        mistake = ZERO
    elif math.isnan(last[0]):
        mistake = NO_NUMBER
    raise Fail(
        f'it drives on until something ahead is nearer than {NEAR} m',
        f'it stopped after {drive.way():.2f} m, and the scan sees '
        f'{"nothing" if math.isinf(ahead) else f"{ahead:.2f} m"} ahead',
        mistake,
    )


def _ahead(scan: Sequence[float]) -> float:
    """Return the nearest distance ahead, m; inf if there is nothing."""
    return min((way for way in (*scan[:AHEAD], *scan[-AHEAD:]) if way > 0), default=math.inf)


def _draw() -> list[Trial]:
    """Return drives: to a slanted wall, along one, to thin posts, and past walls on both sides."""
    uniform, nine, side = random.uniform, math.pi / 2, random.choice((-1, 1))
    # Along a wall, in the corner at x = 2.5 m, y = -2.5 m, where there is no post.
    beside, ahead, off = WALL - uniform(0.3, 0.4), uniform(0.75, 1.0), uniform(0.0, 0.05)
    x = WALL - ahead - BURGER.scan_x
    return [
        _slanted(side),
        Trial(random.choice(((x, -beside, 0.0), (beside, -x, 3 * nine)))),
        Trial(random.choice(((-1.7, 1.62 + off, nine), (-1.62 - off, -1.7, 2 * nine)))),
        # Each is seen by one of the inner half of the beams: an even one, and an odd one.
        _thin(side, 2 - uniform(0.05, 0.2), ROD, nothing=0.0),
        _thin(side, random.choice((1, 3)) - uniform(0.05, 0.2), ROD, nothing=math.nan),
        _edge(1, AHEAD - 1),
        _edge(-1, AHEAD),
        # The next beam on each side is none of those ahead.
        _edge(1, AHEAD, stops=False),
        _edge(-1, AHEAD + 1, stops=False),
        *(_slanted(random.choice((-1, 1))) for _ in range(random.randint(1, 2))),
    ]


def _slanted(side: int) -> Trial:
    """Return a drive to a wall whose nearer half is to the left (1) or to the right (-1)."""
    turn = random.uniform(-3, 3)
    slant, ahead = side * random.uniform(0.7, 0.9), random.uniform(0.95, 1.1)
    ends = [(ahead - way * math.sin(slant), way * math.cos(slant)) for way in (-0.6, 0.6)]
    (x1, y1), (x2, y2) = (_turned(point, turn) for point in ends)
    return Trial((0.0, 0.0, turn), walls=[(x1, y1, x2, y2)])


def _thin(side: int, angle: float, radius: float, nothing: float) -> Trial:
    """Return a drive to a thin post to a side, by an angle in degrees, past one on the other side.

    Only such a post is seen by few of the beams ahead, and the others meet `nothing`.
    """
    turn, angle = random.uniform(-3, 3), side * math.radians(angle)
    thin = random.uniform(0.95, 1.1), NEAR * math.sin(angle)
    beside = 0.6, -side * 0.2
    posts = [(*_turned(thin, turn), radius), (*_turned(beside, turn), 0.03)]
    return Trial((0.0, 0.0, turn), nothing=nothing, posts=posts)


def _edge(side: int, outermost: int, *, stops: bool = True) -> Trial:
    """Return a drive past a wall along the way that only the outermost beam of a side meets near.

    Args:
        side: 1 for the left, -1 for the right.
        outermost: How many degrees from ahead that beam looks.
        stops: Whether that is to stop it; otherwise a wall ahead does, before it is there.
    """
    turn, begin = random.uniform(-3, 3), random.uniform(0.95, 1.1) - 0.3 * (not stops)
    # The outermost beam meets it nearer than what is too near, the next one farther away, wherever
    # the robot is. So it can be long enough for each scan and timer.
    off = side * NEAR * sum(math.sin(math.radians(outermost - n)) for n in (0, 1)) / 2
    walls = [((begin, off), (begin + 0.2, off))]
    if not stops:
        walls.append(((begin + 0.25, -0.3), (begin + 0.25, 0.3)))
    ends = [(*_turned(one, turn), *_turned(other, turn)) for one, other in walls]
    return Trial((0.0, 0.0, turn), walls=ends)


def _turned(point: tuple[float, float], turn: float) -> tuple[float, float]:
    (x, y), c, s = point, math.cos(turn), math.sin(turn)
    return c * x - s * y, s * x + c * y


def _tell(drives: Sequence[Drive]) -> str:
    gaps = [_ahead(drive.scans[-1][1]) for drive in drives]
    return f'It stopped {", ".join(f"{gap:.2f} m" for gap in gaps)} in front of the walls.'


exercise = Exercise(
    words=WORDS,
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=(
        Begins(*SIGN),
        _Scans('/scan', SCAN, SIGN[0]),
        Asked(
            WORDS.of(hz=FEWEST_HZ).clause('speed'),
            _speed,
        ),
        Asked(
            WORDS.clause('stops-in-time'),
            _stops_in_time,
        ),
        Asked(WORDS.clause('drives-on'), _drives_on),
        STOPS,
    ),
    # The longest drive is 1 m, which takes 5 s.
    stage=Drives(SIGN, _draw, _tell, seconds=9.0),
)
