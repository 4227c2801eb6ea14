"""The arena: what it hears of a real robot, what it tells the page, and that it lets go."""

from __future__ import annotations

import base64
import math
import re
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from labkit.sim.kinematics import Pose, Twist2
from labkit.sim.robots import BURGER
from labkit.views.arena_picture import Scene, bounds, joined, row, to_svg
from labkit.views.arena_robot import MappedRobot

ROBOT = """
import labkit as lab
from geometry_msgs.msg import Twist
from labkit.background.runtime import runtime
from rclpy.node import Node
robot = lab.spin(lab.Turtlebot(lockstep=0.1))
pilot = lab.spin(Node('pilot'))
commands = pilot.create_publisher(Twist, '/cmd_vel', 10)

def drive(v, w, steps):
    for _ in range(steps):
        before = robot.simulator.time
        message = Twist()
        message.linear.x, message.angular.z = v, w
        commands.publish(message)
        lab.wait_until(lambda: robot.simulator.time > before)
"""
# The hidden node's subscriptions and timers: what an arena has, and what is left of it.
COUNT = 'print(len(list(runtime.helper.subscriptions)), len(list(runtime.helper.timers)))'
# Keeps what goes to the page, as a page would get it, and says what a page would say.
SPY = """
sent = []
page = view._widget
page.send = lambda content, buffers=None: sent.append((content, buffers))

def say(word):
    page._handle_custom_msg({'view': word}, [])

def told(name=''):
    return [c['robots'][name] for c, _ in sent if name in c.get('robots', ())]
"""


def shown(result):
    assert not result.error, result.traceback
    return result.outputs[0]['data']


def picture_of(data):
    return base64.b64decode(data['text/html'].partition('base64,')[2].partition('"')[0]).decode()


def test_words_and_picture_of_a_robot(kernel):
    kernel.run(ROBOT)
    result = kernel.run('view = lab.arena(goals=[(1.0, 0.5)])\nview')
    data, page = (output['data'] for output in result.outputs)
    assert data['text/plain'] == (
        'Robot at x = 0.00 m, y = 0.00 m, heading 0°. It stands. '
        'Nearest obstacle 1.81 m away, 124° to the right.'
    )
    assert list(page) == ['application/vnd.jupyter.widget-view+json']
    picture = ElementTree.fromstring(picture_of(data))
    assert data['text/plain'] in ''.join(picture.itertext())
    kernel.run('drive(0.2, 0.0, 20)')
    text = 'x = 0.39 m, y = 0.00 m, heading 0°. It drives at 0.20 m/s and turns at 0.00 rad/s.'
    assert text in kernel.run('print(view)').text
    assert 'polyline' in picture_of(shown(kernel.run('view')))


@pytest.mark.slow('waits in real time')
def test_before_a_robot_is_heard_it_says_what_to_do(kernel):
    kernel.run('import labkit as lab')
    data = shown(kernel.run('lab.arena()'))
    assert 'Nothing was heard on /odom yet. Start a robot' in data['text/plain']
    data = shown(kernel.run("lab.arena(namespace='robot1')"))
    assert '/robot1/odom' in data['text/plain']
    kernel.run(
        'from nav_msgs.msg import Odometry\nfrom rclpy.node import Node\n'
        'mute = lab.spin(Node("mute"))\nmute.create_publisher(Odometry, "odom", 10)'
    )
    data = shown(kernel.run('lab.arena()'))
    assert '/mute has a publisher on /odom' in data['text/plain']
    assert 'Start a robot' not in data['text/plain']


def test_headless_it_is_a_picture_and_no_widget(start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run(ROBOT)
    before = kernel.run(COUNT).text
    data = shown(kernel.run('view = lab.arena()\nview'))
    assert set(data) == {'text/plain', 'image/svg+xml'}
    # Then it listens no more: nobody looks on, and a robot may say much.
    assert kernel.run(COUNT).text == before
    kernel.run('drive(0.2, 0.0, 10)')
    assert 'x = 0.19 m' in shown(kernel.run('view'))['text/plain']
    kernel.run('robot.place()\ndrive(0.0, 0.0, 1)')
    data = shown(kernel.run('lab.arena()'))
    # The same again: what is stored must not depend on the run.
    assert shown(kernel.run('lab.arena()')) == data


def test_scan_that_comes_before_the_odometry_is_not_lost(kernel):
    kernel.run(ROBOT)
    kernel.run(
        'from nav_msgs.msg import Odometry\nfrom sensor_msgs.msg import LaserScan\n'
        "scan = lab.wait_for_message('/scan', LaserScan)\n"
        "odometry = lab.wait_for_message('/odom', Odometry)\n"
        "view = lab.arena(odom='/elsewhere', scan='/nowhere')"
    )
    text = kernel.run(
        "robot = view._robots['']\nrobot.take_scan(scan)\nrobot.take_odometry(odometry)\n"
        'print(view.text)'
    ).text
    assert 'Nearest obstacle 1.81 m away' in text


def odometry(sec, x, v=0.0, w=0.0):
    message = Odometry()
    message.header.stamp.sec, message.header.stamp.nanosec = sec, 0
    message.pose.pose.position.x = x
    message.pose.pose.orientation.w = 1.0
    message.twist.twist.linear.x, message.twist.twist.angular.z = v, w
    return message


def scan_at(sec, nanosec=0):
    """Return a scan of one beam, straight ahead."""
    message = LaserScan(range_min=0.1, range_max=3.5, ranges=[1.0])
    message.header.stamp.sec, message.header.stamp.nanosec = sec, nanosec
    return message


@pytest.fixture
def mapped():
    robot: Any = MappedRobot('', [])
    robot.feeds = [SimpleNamespace(topic='/odom'), SimpleNamespace(topic='/scan')]
    return robot


def seen_at(robot):
    return [pytest.approx(end, abs=1e-3) for end in robot.current_scene().scan]


AHEAD = 1.0 + BURGER.scan_x


def test_a_scan_is_drawn_where_the_robot_was_at_its_time(mapped):
    mapped.take_odometry(odometry(10, 0.0, v=0.2))
    mapped.take_scan(scan_at(15))
    assert seen_at(mapped) == []  # where it was then is not known yet
    mapped.take_odometry(odometry(15, 1.0))
    assert seen_at(mapped) == [(1.0 + AHEAD, 0.0)]
    # Late, and between two messages of the odometry.
    mapped.take_scan(scan_at(12))
    assert seen_at(mapped) == [(0.4 + AHEAD, 0.0)]
    mapped.take_odometry(odometry(16, 1.0, w=math.pi))
    mapped.take_odometry(odometry(17, 1.0))
    mapped.take_scan(scan_at(16, 500_000_000))
    assert seen_at(mapped) == [(1.0, AHEAD)]


@pytest.mark.parametrize('sec', [0, 9, 1_000])
def test_a_scan_of_another_clock_is_drawn_where_the_robot_is(mapped, sec):
    mapped.take_odometry(odometry(10, 0.0, v=0.2))
    mapped.take_odometry(odometry(11, 0.2))
    mapped.take_scan(scan_at(sec))
    assert seen_at(mapped) == [(0.2 + AHEAD, 0.0)]
    # And of one whose odometry does not come, after a while.
    for _ in range(100):
        mapped.take_scan(scan_at(12))
    assert seen_at(mapped) == [(0.2 + AHEAD, 0.0)]


def test_a_robot_whose_clock_begins_anew_is_drawn(mapped):
    for sec in (100, 0):
        mapped.take_odometry(odometry(sec, sec / 100))
        mapped.take_scan(scan_at(sec))
        assert seen_at(mapped) == [(sec / 100 + AHEAD, 0.0)]


def test_a_robot_that_has_gone_is_on_the_map_no_more(kernel):
    kernel.run(ROBOT)
    kernel.run(f'view = lab.arena()\n{SPY}\ndisplay(view)\nsay("seen")')
    assert not kernel.run('lab.wait_until(lambda: any("pose" in c for c in told()))').error
    kernel.run('lab.remove(robot)')
    assert not kernel.run('lab.wait_until(lambda: told()[-1] == {"gone": True})').error
    gone = 'The robot has gone. Start a robot with lab.spin(lab.Turtlebot()).\n'
    assert kernel.run('print(view.text)').text == gone
    kernel.run('sent.clear()\nrobot = lab.spin(lab.Turtlebot())')
    assert not kernel.run('lab.wait_until(lambda: any("pose" in c for c in told()))').error
    assert kernel.run('print(view)').text.startswith('Robot at x = 0.00 m')


def test_closing_leaves_nothing(kernel):
    kernel.run(ROBOT)
    before = kernel.run(COUNT).text
    kernel.run('with lab.arena() as view:\n    pass')
    assert kernel.run(COUNT).text == before
    kernel.run(f'view = lab.arena()\n{SPY}')
    assert kernel.run(COUNT).text == before
    # Before the page says that it is there: it can't while a cell lets the robot drive.
    kernel.run('display(view)')
    assert kernel.run(COUNT).text != before
    # Nobody sees it any more, then somebody does again.
    kernel.run("say('gone')")
    assert kernel.run(COUNT).text == before
    kernel.run("say('seen')")
    assert kernel.run(COUNT).text != before
    kernel.run('view.close()')
    kernel.run("say('seen')")
    assert kernel.run(COUNT).text == before
    kernel.run('view.close(); lab.stop(); view.close(); print(view)')


def test_page_is_told_what_is_new_and_no_more(kernel):
    kernel.run(ROBOT)
    kernel.run(f'view = lab.arena(goals=[(1.0, 0.5)])\n{SPY}\ndisplay(view)')
    kernel.run('sent.clear()\nsay("seen")')
    # What this test has sent itself.
    first = eval(kernel.run('print(next(c for c, _ in sent if "goals" in c))').text)
    robot = first['robots']['']
    assert robot['pose'] == (0, 0, 0, 0, 0) and robot['trail'] == [0, 0]
    assert first['goals'] == [(1.0, 0.5)] and 'It stands' in first['text']
    kernel.run(
        'drive(0.2, 0.0, 10)\n'
        'lab.wait_until(lambda: any(c["pose"][0] > 0.19 for c in told() if "pose" in c))'
    )
    trail = kernel.run('print([n for c in told() for n in c.get("trail", ())])').text
    scans = kernel.run('print(sum(b is not None for _, b in sent))').text
    # The whole path in order, though there may be fewer messages than there was odometry.
    xs = eval(trail)[::2]
    assert xs == sorted(xs) and xs[-1] == pytest.approx(0.19, abs=0.02) and len(xs) == 11
    assert 1 <= int(scans) <= 6
    assert kernel.run('print({len(b[0]) for _, b in sent if b})').text == '{2880}\n'
    # The words of where it has come to follow even if nothing else is said any more.
    kernel.run('lab.wait_until(lambda: "x = 0.19 m" in str([c.get("text") for c, _ in sent]))')


def test_robot_that_was_put_elsewhere_has_a_new_trail(kernel):
    kernel.run(ROBOT)
    kernel.run('view = lab.arena()\ndisplay(view)\ndrive(0.2, 0.0, 5)')
    kernel.run('robot.place(x=-1.0)\ndrive(0.2, 0.0, 5)')
    kernel.run('lab.wait_until(lambda: view.scenes[""].pose.x < -0.9)')
    assert float(kernel.run('print(max(x for x, _ in view.scenes[""].trail))').text) < -0.8


@pytest.mark.slow('waits in real time')
def test_a_bump_is_told_until_the_robot_drives_on(kernel):
    kernel.run(ROBOT)
    kernel.run(f'view = lab.arena()\n{SPY}\ndisplay(view)\nrobot.place(x=2.2)')
    for v, side in ((0.2, 'ahead'), (-0.2, 'behind')):
        # First at a distance: the scanner is blind to what is near behind it.
        kernel.run(f'robot.place(x={"2.2" if v > 0 else "2.1"}, yaw={0 if v > 0 else math.pi})')
        kernel.run('drive(0.0, 0.0, 3)\nsent.clear()')
        kernel.run(f'drive({v}, 0.0, 20)')
        kernel.run('lab.wait_until(lambda: "It bumped into something" in view.text)')
        assert f'bumped into something, {side}.' in kernel.run('print(view)').text
        kernel.run('lab.wait_until(lambda: any(c.get("bump") for c in told()))')
        bump = eval(kernel.run('print([c["bump"] for c in told() if c.get("bump")][-1])').text)
        assert bump == pytest.approx((2.5, 0.0), abs=0.03)
        data = shown(kernel.run('view'))
        assert 'It bumped' in data['text/plain'] and 'polygon' in picture_of(data)
        kernel.run(f'drive({-v}, 0.0, 3)')
        kernel.run('lab.wait_until(lambda: "bumped" not in view.text)')
    # To stop where nothing is near is none.
    kernel.run('robot.place()\ndrive(0.2, 0.0, 5)\ndrive(0.0, 0.0, 3)')
    kernel.run(
        'def stopped():\n    scene = view.scenes[""]\n'
        '    return scene.twist.v == 0 and scene.pose.x > 0.05\nlab.wait_until(stopped)'
    )
    assert 'bumped' not in kernel.run('print(view)').text


def test_page_that_comes_later_learns_what_was_seen_before(kernel):
    kernel.run(ROBOT)
    kernel.run(f'view = lab.arena()\n{SPY}\ndisplay(view)\nsay("seen")')
    kernel.run('drive(0.2, 0.0, 3)\nrobot.place(x=-1.0, y=-0.5)\ndrive(0.2, 0.0, 3)')
    kernel.run('lab.wait_until(lambda: view.scenes[""].pose.x > -0.99)\nsent.clear()\nsay("seen")')
    kernel.run(
        'import numpy as np\n'
        'news, buffers = next((c, b) for c, b in sent if "met" in str(c))\n'
        'met = np.frombuffer(buffers[-1], "<f4").reshape(-1, 2)'
    )
    # More than the 360 beams of a scan, each at a wall or a post.
    assert int(kernel.run('print(len(met))').text) > 400
    assert kernel.run('print(bool((abs(met) < 2.51).all()))').text == 'True\n'
    # The page scrolls there once, and not when it is loaded again.
    kernel.run(f'view = lab.arena()\n{SPY}\ndisplay(view)\ndrive(0.2, 0.0, 2)')
    kernel.run(
        'lab.wait_until(lambda: any("pose" in c for c in told()))\nsay("seen")\nsay("seen")'
    )
    told = kernel.run('print([c["fresh"] for c, _ in sent if "fresh" in c])').text
    assert told == '[True, False]\n'


@pytest.mark.slow('waits in real time')
def test_says_why_nothing_comes(kernel):
    kernel.run(ROBOT)
    # In one process, a publisher of another type would keep it from subscribing.
    kernel.run("pilot.create_publisher(Twist, '/elsewhere', 10)")
    assert not kernel.run(f"view = lab.arena(odom='/elsewhere')\n{SPY}\ndisplay(view)").error
    note = kernel.run('say("seen")\nprint([c["note"] for c, _ in sent if "note" in c][-1])').text
    assert '/pilot publishes on /elsewhere, but messages of another type' in note
    # The robot that was there goes.
    kernel.run(f'view = lab.arena()\n{SPY}\ndisplay(view)\nlab.remove(robot)')
    said = kernel.run('lab.wait_until(lambda: "Nobody publishes on /odom" in str(sent))')
    assert not said.error


ROBOTS = """
import labkit as lab
from geometry_msgs.msg import Twist
from labkit.sim.world import playground
from rclpy.node import Node
world = playground()
first = lab.spin(lab.Turtlebot(namespace='robot1', world=world, lockstep=0.1))
view = lab.arena(goals=[(1.0, 0.5)])
display(view)
second = lab.spin(lab.Turtlebot(namespace='robot2', world=world, x=1.0, lockstep=0.1))
pilot = lab.spin(Node('pilot'))
commands = pilot.create_publisher(Twist, '/robot1/cmd_vel', 10)

def drive(v, steps):
    for _ in range(steps):
        before = first.simulator.time
        message = Twist()
        message.linear.x = v
        commands.publish(message)
        lab.wait_until(lambda: first.simulator.time > before)
"""


def test_all_robots_are_on_one_map_also_those_that_come_later(kernel):
    assert not kernel.run(ROBOTS).error
    assert not kernel.run('lab.wait_until(lambda: "robot2 at" in view.text)').error
    data = shown(kernel.run('view'))
    assert [line.partition(',')[0] for line in data['text/plain'].splitlines()] == [
        'robot1 at x = 0.00 m',
        'robot2 at x = 1.00 m',
    ]
    # They see each other's bodies: one by its first scan, the other one by its next.
    assert 'Nearest obstacle 0.86 m away, behind.' in data['text/plain']
    kernel.run('drive(0.0, 3)')
    assert not kernel.run('lab.wait_until(lambda: "0.93 m away, ahead" in view.text)').error
    picture = ElementTree.fromstring(picture_of(data))
    texts = [text.text for text in picture.iter('{http://www.w3.org/2000/svg}text')]
    assert texts.count('robot1') == texts.count('robot2') == 1
    # The other one is no wall that stays there; what it is bumped into is shown.
    near = 'any(math.dist(w, (1, 0)) < 0.2 for w in view._robots["robot1"]._walls.values())'
    assert kernel.run(f'import math\nprint({near})').text == 'False\n'
    kernel.run('drive(0.2, 50)')
    kernel.run('lab.wait_until(lambda: "bumped into something, ahead" in view.text)')
    bump = eval(kernel.run('print(view.scenes["robot1"].bump)').text)
    assert bump == pytest.approx((0.895, 0.0), abs=0.01)
    # One of them alone.
    alone = kernel.run("print(lab.arena(namespace='robot2'))").text
    assert alone.startswith('robot2 at x = 1.00 m') and 'robot1' not in alone


def test_print_tells_what_is_heard_and_listens_no_more(kernel):
    kernel.run(ROBOT)
    before = kernel.run(COUNT).text
    assert 'Robot at x = 0.00 m' in kernel.run('print(lab.arena())').text
    assert kernel.run(COUNT).text == before


def test_goals_that_are_none_are_refused(kernel):
    kernel.run('import labkit as lab')
    for goals in ('[1, 2]', '3', "[('a', 'b')]", '[(1.0, float("nan"))]'):
        assert 'goals must be pairs of numbers' in kernel.run(f'lab.arena(goals={goals})').error


@pytest.mark.parametrize(
    ('scene', 'words'),
    [
        (Scene(), ''),
        (
            Scene(pose=Pose(-0.001, 2.0, math.pi)),
            'Robot at x = 0.00 m, y = 2.00 m, heading 180°. It stands.',
        ),
        (Scene(pose=Pose(), twist=Twist2(-0.1, 0.5)), 'It drives at -0.10 m/s and turns at 0.50'),
        (
            Scene(pose=Pose(1.0, 0.0, math.pi / 2), bump=(0.9, 0.0)),
            'It stands. It bumped into something, 90° to the left.',
        ),
        (Scene(pose=Pose(), reach=3.5), 'Nothing within 3.5 m.'),
        (Scene(pose=Pose(), reach=3.5, nearest=(1.0, 0.05)), '1.00 m away, ahead.'),
        (Scene(pose=Pose(), reach=3.5, nearest=(1.0, -3.14)), '1.00 m away, behind.'),
        (Scene(pose=Pose(), reach=3.5, nearest=(1.0, -1.0)), '57° to the right.'),
    ],
)
def test_scene_in_words(scene, words):
    assert words in scene.words()


def test_walls_are_joined_and_gaps_are_not():
    # Two beams on a wall ahead, then one on a wall far behind it, then one into nothing.
    ends = [(1.0, 0.0), (1.0, 0.2), (9.0, 2.0), None, *[None] * 28]
    assert joined(ends, (0.0, 0.0)) == [(ends[0], ends[1])]
    assert joined([], (0.0, 0.0)) == []


def test_picture_shows_everything_that_is_there():
    left, bottom, right, top = bounds([(3.1, -2.2)])
    assert (left, bottom, right, top) == (-1.5, -2.5, 3.5, 1.5)
    scene = Scene(pose=Pose(0.5, 0.5, 1.0), trail=[(0, 0), (0.5, 0.5)], goals=[(1, 1), (3.1, -2)])
    picture = to_svg(scene, '<script>')
    root = ElementTree.fromstring(picture)
    assert 'script' not in {element.tag.rpartition('}')[2] for element in root.iter()}
    numbers = [float(n) for n in re.findall(r'c[xy]="([\d.-]+)"', picture)]
    assert len(numbers) == 6 and all(0 <= number <= 520 for number in numbers)


@pytest.mark.parametrize('far', [27.0, 600_000.0, 3.3e38])
def test_a_robot_may_be_far_from_where_its_map_begins(far):
    """As outdoors, with coordinates of a whole country."""
    picture = to_svg(Scene(pose=Pose(far, -far, 1.0)))
    ElementTree.fromstring(picture)
    assert 5 < picture.count('<text') < 60


def test_pictures_in_a_row_are_as_large_as_what_happens_in_them():
    near = Scene(pose=Pose(0.1, 0.0, 0.0), trail=[(0.0, 0.0), (0.1, 0.0)], goals=[(0.2, 0.0)])
    far = Scene(pose=Pose(3.0, 0.0, 0.0), trail=[(0.0, 0.0), (3.0, 0.0)])
    picture = row([near, far], 'two & drives')
    root = ElementTree.fromstring(picture)
    name = '{http://www.w3.org/2000/svg}'
    first, second = root.findall(f'{name}svg')
    assert root.findtext(f'{name}title') == 'two & drives'
    assert first.get('x') == '0' and int(second.get('x')) >= int(first.get('width'))
    sizes = [float(part.findall(f'.//{name}circle')[0].get('r')) for part in (first, second)]
    assert sizes[0] > 3 * sizes[1]
    labels = {text.text for text in first.iter(f'{name}text')}
    assert {'0 m', '0.2', '-0.2'} <= labels


GOAL = """
from geometry_msgs.msg import PoseStamped
heard = []
ear = lab.spin(Node('ear'))
ear.create_subscription(PoseStamped, '{topic}', heard.append, 10)
view = lab.arena({arguments})
view._widget._handle_custom_msg({{'view': 'seen'}}, [])
"""


def set_goal(kernel, content):
    kernel.run(f'from math import nan\nview._widget._handle_custom_msg({content}, [])')


def test_a_goal_of_the_page_is_published_to_all_who_listen(kernel):
    kernel.run(ROBOT)
    kernel.run(GOAL.format(topic='/goal_pose', arguments=''))
    kernel.run('lab.wait_until(lambda: view.scenes[""].pose is not None, timeout_sec=20)')
    set_goal(kernel, {'goal': [1, 0.5, math.pi / 2]})
    text = kernel.run(
        'lab.wait_until(lambda: heard, timeout_sec=20)\ngoal = heard[-1]\n'
        'turn = goal.pose.orientation\n'
        'print(goal.header.frame_id, goal.pose.position.x, goal.pose.position.y, '
        'round(turn.z, 3), round(turn.w, 3), len(heard))'
    ).text
    assert text == 'odom 1.0 0.5 0.707 0.707 1\n'
    assert kernel.run('print(view.scenes[""].goals)').text == '[(1.0, 0.5)]\n'
    said = 'print([p.topic_name for p in runtime.helper.publishers if "goal" in p.topic_name])'
    assert kernel.run(said).text == "['/goal_pose']\n"
    assert kernel.run(f'view.close()\n{said}').text == '[]\n'


def test_the_goal_of_one_of_several_robots_is_in_its_namespace(kernel):
    kernel.run(ROBOT.replace('lab.Turtlebot(', "lab.Turtlebot(namespace='left', "))
    kernel.run(GOAL.format(topic='/left/goal_pose', arguments=''))
    set_goal(kernel, {'goal': [0, 1, 0]})
    assert kernel.run('lab.wait_until(lambda: heard, timeout_sec=20)').error == ''


@pytest.mark.parametrize('goal', ['[1, 2]', '"ab"', '[nan, 1, 2]', '[1, 2, "3"]', 'None', '{}'])
def test_nonsense_of_a_page_is_no_goal(kernel, goal):
    kernel.run(ROBOT)
    kernel.run(GOAL.format(topic='/goal_pose', arguments=''))
    set_goal(kernel, f"{{'goal': {goal}}}")
    assert kernel.run('print(view._goals, view._goal_publisher)').text == '[] None\n'


# -- frames ---------------------------------------------------------------------------------------

# Where the robot is then: x = 0.34 m, y = 0.17 m, heading 55°.
TURNED = f'{ROBOT}\nfrom tf2_msgs.msg import TFMessage\ndrive(0.2, 0.5, 20)'


@pytest.fixture
def still(start_kernel):
    """Give a function that shows an arena with these arguments, without a page."""
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run(TURNED)
    return lambda arguments: shown(kernel.run(f'lab.arena({arguments})'))


def test_axes_of_frames_are_where_tf2_has_them(still):
    data = still("frames=['odom', 'base_scan', 'camera_rgb_optical_frame']")
    first, *axes = data['text/plain'].splitlines()
    assert first.startswith('Robot at x = 0.34 m, y = 0.17 m, heading 55°.')
    # The scanner is 0.032 m behind the middle, the camera 0.040 m ahead of it.
    assert axes == [
        'Frame odom at x = 0.00 m, y = 0.00 m, its x axis at 0°.',
        'Frame base_scan at x = 0.32 m, y = 0.14 m, its x axis at 55°.',
        'Frame camera_rgb_optical_frame at x = 0.36 m, y = 0.20 m, its x axis at -35°.',
    ]
    drawn = [
        each.text for each in ElementTree.fromstring(data['image/svg+xml']).iter() if each.text
    ]
    assert {'odom', 'base_scan', 'camera_rgb_optical_frame', 'z'} <= set(drawn)
    # A camera looks along its z axis, and its y axis points down.
    assert drawn.count('z') == 1


def test_in_a_fixed_frame_the_world_turns_round_the_robot(still):
    plain = still('')['text/plain']
    text = still("frames=['odom'], fixed_frame='base_link'")['text/plain'].splitlines()
    assert text[0] == 'All is told in the frame base_link.'
    assert text[1].startswith('Robot at x = 0.00 m, y = 0.00 m, heading 0°. It drives')
    assert text[2] == 'Frame odom at x = -0.33 m, y = 0.18 m, its x axis at -55°.'
    # What the scanner sees does not depend on who draws it.
    assert text[1].partition('Nearest')[2] == plain.partition('Nearest')[2]


def test_what_tf2_does_not_know_is_named_with_its_reason_and_left_out(still):
    data = still("frames=['bas_scan'], fixed_frame='base_link'")
    *_, last = data['text/plain'].splitlines()
    assert last == (
        'bas_scan can\'t be drawn in base_link: "bas_scan" passed to lookupTransform argument '
        "source_frame does not exist. Did you mean 'base_scan'?"
    )
    data = still("fixed_frame='moon'")
    assert data['text/plain'].startswith('What /odom says can\'t be drawn in moon: "moon" passed')
    assert 'polyline' not in data['image/svg+xml']


def test_a_scan_is_drawn_where_tf2_has_its_scanner_not_where_a_burger_has_it(kernel):
    kernel.run(ROBOT)
    # The wall is 1 m ahead of the scanner, and that is 2 m to the left of the odometry's frame.
    kernel.run("""
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from tf2_ros import StaticTransformBroadcaster
odometry = Odometry()
odometry.header.frame_id, odometry.pose.pose.orientation.w = 'odom', 1.0
scan = LaserScan(range_min=0.1, range_max=3.5, ranges=[1.0])
scan.header.frame_id = 'mast'
mast = TransformStamped()
mast.header.frame_id, mast.child_frame_id = 'odom', 'mast'
mast.transform.translation.y = 2.0
mast.transform.rotation.z = mast.transform.rotation.w = 0.5 ** 0.5
view = lab.arena(odom='/elsewhere', scan='/nowhere', frames=['mast'])
robot = view._robots['']
robot.take_odometry(odometry)
robot.take_scan(scan)
""")
    ends = 'print([[round(n, 3) + 0.0 for n in end] for end in robot.current_scene().scan])'
    assert kernel.run(ends).text.strip() == '[]'
    assert (
        'The scan on /nowhere and mast can\'t be drawn in odom: "odom" passed'
        in kernel.run('print(view.text)').text
    )
    kernel.run('view._frames.heard.set_transform_static(mast, "test")')
    assert kernel.run(ends).text.strip() == '[[0.0, 3.0]]'
    assert "can't be drawn" not in kernel.run('print(view.text)').text


def test_a_scan_that_is_newer_than_the_transforms_waits_for_them(kernel):
    kernel.run(TURNED)
    kernel.run("view = lab.arena(frames=['odom'])\nview._wait_for_first()")
    kernel.run("""
from sensor_msgs.msg import LaserScan
robot_of_map = view._robots['']
late = lab.wait_for_message('/scan', LaserScan)
late.header.stamp.sec += 1
robot_of_map.take_scan(late)
""")
    assert kernel.run('print(len(robot_of_map._waiting))').text == '1\n'
    kernel.run(SPY + "say('seen')\ndrive(0.2, 0.5, 20)")
    kernel.run('lab.wait_until(lambda: not robot_of_map._waiting, timeout_sec=20)')


def test_the_page_gets_axes_and_where_the_odometry_is(kernel):
    kernel.run(TURNED)
    kernel.run("view = lab.arena(frames=['odom'], fixed_frame='base_link')" + SPY + "say('seen')")
    kernel.run("lab.wait_until(lambda: any(c.get('axes') for c, _ in sent))")
    told = kernel.run("""
bases = [c['bases'][''] for c, _ in sent if c.get('bases', {}).get('')]
(name, origin, tips), = [c['axes'] for c, _ in sent if c.get('axes')][-1]
print([round(n, 2) for n in bases[-1]], name, [round(n, 2) for n in origin], sorted(tips))
print([c['fixed'] for c, _ in sent if 'fixed' in c][0])
""").text
    assert told == "[-0.33, 0.18, -0.96] odom [-0.33, 0.18] ['x', 'y']\nbase_link\n"
    # Without frames, nobody listens to them.
    kernel.run('view.close()')
    plain = 'view = lab.arena()' + SPY + "say('seen')"
    kernel.run(plain)
    heard = kernel.run('print([s.topic_name for s in runtime.helper.subscriptions])').text
    assert '/tf' not in heard
    assert '/odom' in heard


@pytest.mark.parametrize('arguments', ['frames="odom"', 'frames=[3]', 'fixed_frame=""'])
def test_frames_that_are_no_names_are_refused(kernel, arguments):
    result = kernel.run(f'import labkit as lab\nlab.arena({arguments})')
    assert 'frames is a list of names' in result.traceback
