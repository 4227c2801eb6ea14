"""A robot as imperfect as it is told to be: the statistics are those that were set.

Bounds are four standard errors, so that a right model fails once in ten thousand seeds; the seeds
are fixed.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import rclpy
from nav_msgs.msg import Odometry

from labkit.errors import LabError
from labkit.sim.kinematics import Pose
from labkit.sim.radio import Radio
from labkit.sim.simulator import Simulator
from labkit.sim.slip import PIECE, Slip
from labkit.sim.turtlebot import ODOM_RATE, TRUTH_TOPIC
from labkit.sim.turtlebot_program import TurtlebotProgram
from labkit.sim.world import Wall, World, open_field
from tests.sim.test_simulator import run
from tests.stage import Driver, Stage, twist

WHEELS = 400
FOUR = 4.0


def errors_after(way: float, share: float) -> np.ndarray:
    """Return by how much the encoders of many wheels count too far, m."""
    sources = np.random.SeedSequence(5).spawn(WHEELS)
    return np.array([Slip(share, source).counted(way) - way for source in sources])


@pytest.mark.parametrize('share', [0.01, 0.2])
@pytest.mark.parametrize('way', [1.0, 4.0])
def test_slip_grows_with_the_way_and_its_spread_with_the_root(share: float, way: float) -> None:
    errors = errors_after(way, share)
    spread = share * math.sqrt(PIECE * way)
    assert errors.min() > 0, 'a wheel that slips turns too far'
    assert errors.mean() == pytest.approx(share * way, abs=FOUR * spread / math.sqrt(WHEELS))
    # The standard error of a standard deviation; the sum of so many pieces is nearly normal.
    kurtosis = 3 + 6 * PIECE / way
    relative = FOUR * math.sqrt((kurtosis - 1) / (4 * WHEELS))
    assert errors.std() == pytest.approx(spread, rel=relative)


def test_a_wheel_slips_the_same_in_large_and_small_steps_and_backwards() -> None:
    one, other, back = (Slip(0.1, np.random.SeedSequence(2)) for _ in range(3))
    told = one.counted(2.0)
    assert sum(other.counted(0.004) for _ in range(500)) == pytest.approx(told)
    assert back.counted(-2.0) == -told
    assert one.counted(0.0) == 0.0


def drive(robot: Simulator) -> Simulator:
    return run(robot, [(0.2, 0.5, 5.0), (-0.1, 0.0, 3.0), (0.2, -0.7, 4.0)], 20)


def test_a_robot_that_slips_drives_as_it_did_and_believes_its_wheels() -> None:
    perfect, slipping = drive(Simulator(open_field())), drive(Simulator(open_field(), slip=0.05))
    assert slipping.pose == perfect.pose == perfect.odometry
    assert math.dist(slipping.odometry[:2], slipping.pose[:2]) > 0.01
    left, right = (told / true for told, true in zip(slipping.wheels, perfect.wheels, strict=True))
    assert left > 1 and right > 1 and left != right
    # Odometry is what the wheels say.
    turned = (slipping.wheels[1] - slipping.wheels[0]) * 0.033 / 0.160
    assert math.remainder(slipping.odometry.yaw - turned, math.tau) == pytest.approx(0, abs=1e-9)
    v, w = slipping.odometry_twist
    rates = slipping.wheel_rates
    assert v == pytest.approx(0.033 * sum(rates) / 2)
    assert w == pytest.approx(0.033 * (rates[1] - rates[0]) / 0.160)


def test_the_heading_of_many_robots_spreads_as_their_wheels_slip() -> None:
    share, count = 0.01, 200
    robots = [
        Simulator(open_field(), slip=share, seed=seed, command_timeout=None)
        for seed in range(count)
    ]
    ends = [run(robot, [(0.2, 0.0, 10.0)], 10) for robot in robots]
    way = ends[0].pose.x
    assert way == pytest.approx(2.0, abs=0.01)
    yaws = np.array([robot.odometry.yaw for robot in ends])
    assert {robot.pose for robot in ends} == {ends[0].pose}
    # Two wheels, which slip independently, 0.16 m apart.
    spread = math.sqrt(2) * share * math.sqrt(PIECE * way) / 0.160
    assert yaws.mean() == pytest.approx(0, abs=FOUR * spread / math.sqrt(count))
    assert yaws.std() == pytest.approx(spread, rel=FOUR * math.sqrt(1.1 / (2 * count)))


def test_the_same_seed_slips_in_the_same_way() -> None:
    def believes(seed: int) -> Pose:
        return drive(Simulator(open_field(), slip=0.05, seed=seed)).odometry

    assert believes(1) == believes(1) != believes(2)
    again = drive(Simulator(open_field(), slip=0.05, seed=1))
    again.place(Pose())
    assert drive(again).odometry == believes(1)


def test_slip_and_noise_do_not_disturb_each_other() -> None:
    assert Simulator(noise=0.01, slip=0.1).scan() == Simulator(noise=0.01).scan()


def test_the_noise_of_ranges_is_what_was_set() -> None:
    noise, count = 0.02, 40
    # So large a room that no beam is cut off, and so small that each one meets a wall.
    walls = [(-1, -1, 1, -1), (1, -1, 1, 1), (1, 1, -1, 1), (-1, 1, -1, -1)]
    exact = np.array(Simulator(World([Wall(*wall) for wall in walls])).scan())
    robot = Simulator(World([Wall(*wall) for wall in walls]), noise=noise)
    wrong = np.array([robot.scan() for _ in range(count)]) - exact
    assert wrong.mean() == pytest.approx(0, abs=FOUR * noise / math.sqrt(wrong.size))
    assert wrong.std() == pytest.approx(noise, rel=FOUR / math.sqrt(2 * wrong.size))


class Line:
    """What arrives of a topic, and when."""

    def __init__(self, topic_name: str = '/scan') -> None:
        self.topic_name = topic_name
        self.now = 0.0
        self.heard: list[tuple[Any, float]] = []

    def publish(self, message: Any) -> None:
        self.heard.append((message, self.now))


def sent(radio: Radio, period: float, count: int, topic_name: str = '/scan') -> Line:
    """Send the number of each message, in rounds of 0.01 s; return what arrives."""
    line, rounds = Line(topic_name), round(period / 0.01)
    for step in range(count * rounds + 1000):
        line.now = step * 0.01
        if step % rounds == 0 and step < count * rounds:
            radio.send(line, step // rounds, line.now)
        radio.deliver(line.now)
    return line


def test_messages_are_as_late_as_was_set() -> None:
    latency, count = 0.2, 2000
    line = sent(Radio(latency, 0.0, seed=1, early=0.005), 0.2, count)
    assert [number for number, _ in line.heard] == list(range(count))
    delays = np.array([at - 0.2 * number for number, at in line.heard])
    # To the nearest round.
    assert latency / 2 - 0.006 < delays.min() and delays.max() < 1.5 * latency + 0.006
    spread = latency / math.sqrt(12)
    assert delays.mean() == pytest.approx(latency, abs=FOUR * spread / math.sqrt(count))
    # Uniform: its kurtosis is 1.8.
    assert delays.std() == pytest.approx(spread, rel=FOUR * math.sqrt(0.8 / (4 * count)))


def test_no_message_overtakes_another() -> None:
    line = sent(Radio(0.2, 0.0, seed=1, early=0.005), 0.03, 500)
    assert [number for number, _ in line.heard] == list(range(500))
    assert max(at - 0.03 * number for number, at in line.heard) < 0.306


@pytest.mark.parametrize('latency', [0.0, 0.1])
def test_as_many_messages_are_lost_as_was_set(latency: float) -> None:
    loss, count = 0.3, 2000
    line = sent(Radio(latency, loss, seed=1, early=0.005), 0.05, count)
    lost = 1 - len(line.heard) / count
    assert lost == pytest.approx(loss, abs=FOUR * math.sqrt(loss * (1 - loss) / count))
    # Each by itself: after a lost one, the next is lost no more often.
    gone = np.ones(count, bool)
    gone[[number for number, _ in line.heard]] = False
    after = gone[1:][gone[:-1]]
    assert after.mean() == pytest.approx(
        loss, abs=FOUR * math.sqrt(loss * (1 - loss) / after.size)
    )


def test_the_same_seed_loses_the_same_messages_of_a_topic() -> None:
    def heard(seed: int, latency: float = 0.0, topic: str = '/scan') -> list[int]:
        radio = Radio(latency, 0.3, seed, early=0.005)
        return [number for number, _ in sent(radio, 0.05, 200, topic).heard]

    assert heard(1) == heard(1) == heard(1, latency=0.1)
    assert heard(1) != heard(2) and heard(1) != heard(1, topic='/odom')
    radio = Radio(0.0, 0.3, 1, early=0.005)
    first = [number for number, _ in sent(radio, 0.05, 200).heard]
    radio.restart()
    assert [number for number, _ in sent(radio, 0.05, 200).heard] == first
    assert not sent(Radio(0.0, 1.0, 1, early=0.005), 0.05, 50).heard


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'slip': -0.1}, 'slip must be a share'),
        ({'slip': 2}, 'slip must be a share'),
        ({'latency': math.inf}, 'latency must be a time'),
        ({'latency': math.nan}, 'latency must be a time'),
        ({'loss': 1.5}, 'loss must be a probability'),
        ({'seed': -1}, 'seed must be a whole number'),
    ],
)
def test_an_imperfection_without_sense_is_told(
    stage: Stage, arguments: dict[str, float], words: str
) -> None:
    with pytest.raises(LabError, match=words):
        stage.robot(**arguments)


class Witness(Driver):
    """A driver that also knows the truth."""

    def __init__(self) -> None:
        super().__init__()
        self.truth: list[Odometry] = []
        self.create_subscription(Odometry, TRUTH_TOPIC, self.truth.append, 1000)


def seconds(message: Odometry) -> float:
    return message.header.stamp.sec + message.header.stamp.nanosec * 1e-9


def steps(stage: Stage, count: int, **options: Any) -> tuple[Any, Witness]:
    """Drive in lock-step, 0.1 s a command, and wait for the truth after each."""
    robot = stage.robot(world=open_field(), lockstep=0.1, **options)
    witness = stage.add(Witness())
    stage.until(lambda: witness.commands.get_subscription_count() and witness.truth)
    stage.until(lambda: witness.odometry)
    for step in range(1, count + 1):
        witness.commands.publish(twist(0.2, 0.1))
        stage.until(lambda step=step: round(seconds(witness.truth[-1]) / 0.1) == step)
        now = seconds(witness.truth[-1])
        latency = options.get('latency', 0.0)
        assert seconds(witness.odometry[-1]) <= max(0.0, now - latency / 2 + 0.051)
    return robot, witness


def test_the_truth_is_on_a_topic_of_its_own(stage: Stage) -> None:
    robot, witness = steps(stage, 40, slip=0.05, drift=0.02)
    stage.until(lambda: seconds(witness.odometry[-1]) > 3.95)
    truth, believed = witness.truth[-1], witness.odometry[-1]
    assert (truth.header.frame_id, truth.child_frame_id) == ('map', 'base_footprint')
    place = truth.pose.pose.position
    assert (place.x, place.y) == robot.pose[:2]
    told = believed.pose.pose.position
    assert (told.x, told.y) == robot.simulator.odometry[:2] != robot.pose[:2]
    assert truth.twist.twist.linear.x == 0.2 != believed.twist.twist.linear.x
    stage.until(lambda: seconds(witness.joints[-1]) > 3.95)
    assert tuple(witness.joints[-1].position) == robot.simulator.wheels


def test_late_and_lost_messages_of_a_robot_are_the_same_each_time(stage: Stage) -> None:
    def heard() -> list[float]:
        robot, witness = steps(stage, 60, latency=0.4, loss=0.3, seed=4)
        # What was sent by then has arrived, and nothing since.
        stage.until(lambda: seconds(witness.odometry[-1]) > 5.0)
        for node in (robot, witness):
            stage.executor.remove_node(node)
            stage.nodes.remove(node)
            node.destroy_node()
        return [round(seconds(one), 6) for one in witness.odometry if seconds(one) < 5.0]

    first = heard()
    assert first == sorted(set(first)) and len(first) < 45
    assert first == heard()


def test_a_perfect_robot_has_no_truth_of_its_own(stage: Stage) -> None:
    robot = stage.robot(noise=0.01)
    assert not robot.count_publishers(f'/{TRUTH_TOPIC}')


@pytest.mark.parametrize('options', [{'drift': 0.01}, {'slip': 0.01}, {'loss': 0.1}])
def test_an_imperfect_one_has(stage: Stage, options: dict[str, float]) -> None:
    robot = stage.robot(namespace='one', **options)
    assert robot.count_publishers(f'/one/{TRUTH_TOPIC}') == 1


def test_late_messages_come_in_fast_time_too(stage: Stage) -> None:
    stage.robot(world=open_field(), speed=5.0, latency=0.5)
    witness = stage.add(Witness())
    stage.until(lambda: len(witness.odometry) > 30)
    rounds = [seconds(one) * ODOM_RATE for one in witness.odometry]
    assert all(abs(number - round(number)) < 1e-3 for number in rounds)
    assert rounds == sorted(set(rounds))


def test_they_are_parameters_of_the_program() -> None:
    said = ('drift:=0.01', 'slip:=0.02', 'noise:=0.01', 'latency:=0.1', 'loss:=0.2', 'seed:=7')
    rclpy.init(args=['--ros-args', *(word for one in said for word in ('-p', one))])
    try:
        robot = TurtlebotProgram()
        simulator = robot.simulator
        assert (simulator.drift, simulator.slip, simulator.noise) == (0.01, 0.02, 0.01)
        assert simulator.scan() == Simulator(noise=0.01, seed=7).scan()
        assert robot.count_publishers(f'/{TRUTH_TOPIC}') == 1
        assert not robot._radio.is_perfect
        robot.destroy_node()
    finally:
        rclpy.shutdown()
