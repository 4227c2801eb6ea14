"""Robot and node step together: a drive is the same each time, and who disturbs it is named."""

from __future__ import annotations

import contextlib
import itertools
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from cases.scripts import started_by_subprocess

from labkit.background.domains import claim_domain
from labkit.lessons.turtlebot.bot import exercise as bot
from labkit.lessons.turtlebot.square import exercise as square

Script = Callable[..., Any]

START = """
import labkit as lab
from labkit.lessons.turtlebot import LESSON, drawing

robot = lab.spin(lab.Turtlebot())
"""
PATHS = """
import json
import random

shown = []
drawing._show = shown.extend
for _ in range({checks}):
    random.seed(7)
    assert LESSON.bot.check().passed
paths = [[(time, *pose) for time, pose in drive.poses] for drive in shown]
print(json.dumps([paths[i:i + 2] for i in range(0, len(paths), 2)]))
"""
CHECK = """
print(LESSON.{name}.check())
"""
# The same as the solution, in a thread that sleeps.
SLEEPER = """
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import Empty

node = lab.spin(rclpy.create_node('sleeper'))
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
started = threading.Event()


def send(v, w, steps):
    for _ in range(steps):
        msg = Twist()
        msg.linear.x, msg.angular.z = v, w
        publisher.publish(msg)
        time.sleep(0.1)


def work():
    while started.wait():
        started.clear()
        for _ in range(4):
            send(0.2, 0.0, 20)
            send(0.0, 1.5708, 10)
            send(0.0, 0.0, 5)


node.create_subscription(Empty, '/go_square', lambda msg: started.set(), 10)
threading.Thread(target=work, daemon=True).start()
"""


@contextlib.contextmanager
def busy_machine() -> Iterator[None]:
    """Run eight loops without an end beside the test."""
    loops = [subprocess.Popen([sys.executable, '-c', 'while True: pass']) for _ in range(8)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def paths(script: Script, checks: int) -> list[Any]:
    done = script(START + bot.answer.code + PATHS.format(checks=checks))
    assert done.exit_code == 0, done.stderr
    found: list[Any] = json.loads(done.stdout.splitlines()[-1])
    return found


# A second of the processor takes a dozen beside eight loops and the rest of the suite.
@pytest.mark.slow('whole drives')
@pytest.mark.timeout(600)
def test_same_drive_gives_the_same_path_on_a_calm_and_on_a_busy_machine(script: Script) -> None:
    checks = paths(script, 2)
    with busy_machine():
        checks += paths(script, 1)
    assert len(checks) == 3
    for other in checks[1:]:
        for drive, again in zip(checks[0], other, strict=True):
            numbers = [list(itertools.chain(*path)) for path in (drive, again)]
            assert numbers[0] == pytest.approx(numbers[1], abs=1e-6)


@pytest.mark.slow('several checks')
def test_robot_is_in_real_time_again_after_the_check(script: Script) -> None:
    code = """
from geometry_msgs.msg import Twist

lab.remove('homing_bot')
robot.place()
pilot = robot.create_publisher(Twist, 'cmd_vel', 10)
msg = Twist()
msg.linear.x = 0.2


def driven():
    pilot.publish(msg)
    return robot.pose.x > 0.05


lab.wait_until(driven, timeout_sec=60)
print(robot.get_clock().ros_time_is_active, robot.simulator.robot.range_max)
"""
    done = script(START + bot.answer.code + CHECK.format(name='bot') + code)
    assert 'PASS: bot' in done.stdout
    assert done.stdout.splitlines()[-1] == 'False 3.5', done.stderr


def test_thread_that_sleeps_is_judged_in_virtual_time(script: Script) -> None:
    done = script(START + SLEEPER + CHECK.format(name='square'))
    assert 'PASS: square' in done.stdout, done.stdout + done.stderr


@pytest.mark.slow('works through a lesson')
def test_process_that_sleeps_by_itself_is_told_to_use_a_timer(script: Script) -> None:
    made = "rclpy.create_node('sleeper')"
    program = SLEEPER.replace(f'node = lab.spin({made})', f'rclpy.init()\nnode = {made}')
    started = started_by_subprocess(f'{program}rclpy.spin(node)\n')
    check = f"""
try:
    lab.wait_until(lambda: 'sleeper' in robot.get_node_names(), timeout_sec=60)
    {CHECK.format(name='square').strip()}
finally:
    process.kill()
"""
    claim = claim_domain()
    done = script(
        START + started + check,
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST',
        ROS_DOMAIN_ID=str(claim.domain_id),
    )
    claim.close()
    said = ' '.join(done.stdout.split())
    assert 'FAIL: square' in said, done.stdout + done.stderr
    assert 'In a process of its own let a timer send the commands' in said


STANDING = {
    'a node with a timer': """
import rclpy
from geometry_msgs.msg import Twist

idle = lab.spin(rclpy.create_node('idle'))
zeros = idle.create_publisher(Twist, '/cmd_vel', 10)
idle.create_timer(0.1, lambda: zeros.publish(Twist()))
""",
}


@pytest.mark.slow('several checks')
@pytest.mark.parametrize('other', STANDING)
def test_what_else_drives_by_a_timer_stands_still_meanwhile(script: Script, other: str) -> None:
    done = script(START + bot.answer.code + STANDING[other] + CHECK.format(name='bot'))
    assert 'PASS: bot' in done.stdout, done.stdout + done.stderr


OTHERS = {
    '/teleop': """
import threading
import time

pilot = lab.teleop()


def hold():
    while True:
        pilot._handle_request({'v': 1.0, 'w': 0.0})
        time.sleep(0.1)


threading.Thread(target=hold, daemon=True).start()
""",
    '/pilot': """
import threading
import time

import rclpy
from geometry_msgs.msg import Twist

pilot = lab.spin(rclpy.create_node('pilot'))
commands = pilot.create_publisher(Twist, '/cmd_vel', 10)


def hold():
    while True:
        commands.publish(Twist())
        time.sleep(0.1)


threading.Thread(target=hold, daemon=True).start()
""",
    '/other': "lab.spin(lab.Turtlebot(name='other'))",
    '/watchmaker': """
import rclpy
from rosgraph_msgs.msg import Clock

watchmaker = lab.spin(rclpy.create_node('watchmaker'))
ticks = watchmaker.create_publisher(Clock, '/clock', 10)
watchmaker.create_timer(0.1, lambda: ticks.publish(Clock()))
""",
}


@pytest.mark.parametrize('name', OTHERS)
def test_who_else_drives_is_named(script: Script, name: str) -> None:
    done = script(START + bot.answer.code + OTHERS[name] + CHECK.format(name='bot'))
    said = ' '.join(done.stdout.split())
    assert 'FAIL: bot' in said, done.stderr
    seen = said.partition('Seen:')[2]
    assert name in seen
    assert '/homing_bot' not in seen


ROBOTS = {
    'none': 'lab.remove(robot)',
    'with a clock of its own': 'robot = lab.spin(lab.Turtlebot(speed=8))',
    'in another room': (
        'from labkit.sim.world import room\nrobot = lab.spin(lab.Turtlebot(world=room(3.0, 3.0)))'
    ),
}


@pytest.mark.slow('whole drives')
@pytest.mark.parametrize('name', ROBOTS)
def test_robot_that_is_not_the_one_of_the_lesson(script: Script, name: str) -> None:
    done = script(f'{START}\n{ROBOTS[name]}\n{bot.answer.code}' + CHECK.format(name='bot'))
    said = ' '.join(done.stdout.split())
    assert 'Run the cell again that says: robot = lab.spin(lab.Turtlebot())' in said, done.stderr


FLOODS = {
    'a timer without a period': bot.answer.code.replace('create_timer(0.1,', 'create_timer(0.0,'),
    'a loop in a callback': bot.answer.code.replace(
        '        self.steps = 21\n',
        '        for _ in range(150_000):\n            self.publisher.publish(Twist())\n',
    ),
    'a thread': SLEEPER.replace('        time.sleep(0.1)\n', '').replace(
        'range(4)', 'range(5000)'
    ),
}


@pytest.mark.slow('it drives while the machine is busy')
@pytest.mark.parametrize('name', FLOODS)
def test_flood_of_commands_ends(script: Script, name: str) -> None:
    exercise = square if name == 'a thread' else bot
    done = script(START + FLOODS[name] + CHECK.format(name=exercise.name))
    said = done.stdout.partition(f'FAIL: {exercise.name}')[2]
    assert said, done.stdout + done.stderr
    assert len(said) < 2000
