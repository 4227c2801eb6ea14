"""Teleop: what it publishes for what a page sends, and that the robot stops whatever happens."""

from __future__ import annotations

import pytest

PILOT = """
import labkit as lab
from geometry_msgs.msg import Twist
from labkit.background.runtime import runtime
from rclpy.node import Node

heard = []
ear = lab.spin(Node('ear'))
ear.create_subscription(
    Twist, '/cmd_vel', lambda m: heard.append((round(m.linear.x, 3), round(m.angular.z, 3))), 100)
pilot = lab.teleop(max_speed=0.2, max_turn=2.0)

def page(**content):
    pilot._widget._handle_custom_msg(content, [])

def wait_for(command):
    lab.wait_until(lambda: command in heard)
"""
# Keeps what goes to the page, as a page would get it.
SPY = """
told = []
pilot._widget.send = lambda content, buffers=None: told.append(content)
"""


@pytest.fixture
def pilot(kernel):
    def run(code):
        result = kernel.run(code)
        assert not result.error, result.traceback
        return result.text.strip()

    run(PILOT)
    return run


def test_publishes_while_a_key_is_held_and_stops_at_once(pilot):
    assert pilot('print(heard)') == '[]'
    # A page repeats itself, so that it is known to be there.
    pilot("""
repeat = ear.create_timer(0.1, lambda: page(v=0.5, w=-0.25))
lab.wait_until(lambda: heard.count((0.1, -0.5)) >= 5)
with runtime.executor.between_callbacks():
    ear.destroy_timer(repeat)
page(stop=True)
wait_for((0.0, 0.0))
""")
    assert pilot('print(heard[-1], set(heard[:-1]))') == '(0.0, 0.0) {(0.1, -0.5)}'
    assert pilot('print(pilot.published, pilot.count == len(heard))') == '(0.0, 0.0) True'


@pytest.mark.slow('waits in real time')
def test_while_no_key_is_held_it_publishes_nothing(pilot):
    pilot("""
ticks = []
ear.create_timer(0.1, lambda: ticks.append(len(heard)))
lab.wait_until(lambda: pilot._publisher.get_subscription_count() == 1)
lab.wait_until(lambda: len(ticks) >= 10)
page(v=0.5, w=0.0)
wait_for((0.1, 0.0))
page(stop=True)
wait_for((0.0, 0.0))
ticks.clear()
lab.wait_until(lambda: len(ticks) >= 10)
""")
    assert pilot('print(heard.count((0.0, 0.0)), ticks[-1] == ticks[0])') == '1 True'
    assert pilot('print(heard[0])') == '(0.1, 0.0)'
    assert pilot('print(ear.get_publishers_info_by_topic("/cmd_vel")[0].node_name)') == 'teleop'


def test_stamped_commands_for_robots_that_expect_them(pilot):
    pilot("""
from geometry_msgs.msg import TwistStamped

stamped = []
ear.create_subscription(TwistStamped, '/tb3/cmd_vel', stamped.append, 100)
pilot = lab.teleop(namespace='tb3', stamped=True, max_speed=0.2)
page(v=1, w=0)
lab.wait_until(lambda: stamped)
pilot.stop()
lab.wait_until(lambda: stamped[-1].twist.linear.x == 0.0)
""")
    told = pilot('print(stamped[0].twist.linear.x, stamped[0].header.stamp.sec > 0, pilot)')
    assert told.startswith('0.2 True Teleop publishes geometry_msgs/msg/TwistStamped on /tb3/')


def test_silence_of_the_page_stops_the_robot(pilot):
    pilot('page(v=1, w=0)\nwait_for((0.2, 0.0))\nwait_for((0.0, 0.0))')
    assert pilot('print(heard[-1])') == '(0.0, 0.0)'
    # Once: a stop that is repeated would disturb others that drive.
    assert pilot('print(heard.count((0.0, 0.0)))') == '1'


NONSENSE = (
    *("v=float('nan'), w=0", "v='fast', w=0", 'v=1', 'v=None, w=None', 'w=[1], v={}'),
    *('', 'stop=0', 'v=True'),
)


def test_nonsense_of_a_page_moves_nothing_and_too_much_is_cut(pilot):
    for content in NONSENSE:
        pilot(f'page({content})')
    pilot('page(v=5, w=-5)\nwait_for((0.2, -2.0))\nwait_for((0.0, 0.0))')
    assert pilot('print(sorted(set(heard)))') == '[(0.0, 0.0), (0.2, -2.0)]'


def test_commands_that_waited_for_a_busy_kernel_do_not_move_the_robot(pilot):
    # In a callback, so that no timer ticks in between: they are all taken at once.
    pilot("""
def catch_up():
    ear.destroy_timer(timer)
    for _ in range(50):
        page(v=1, w=0)
    page(stop=True)

timer = ear.create_timer(0.01, catch_up)
wait_for((0.0, 0.0))
""")
    pilot('page(v=0.5, w=0)\nwait_for((0.1, 0.0))')
    assert pilot('print((0.2, 0.0) in heard)') == 'False'


def test_closing_stops_the_robot_and_ends_the_node(pilot):
    pilot(SPY + 'page(v=1, w=0)\nwait_for((0.2, 0.0))\npilot.close()\nwait_for((0.0, 0.0))')
    assert pilot('print([entry.name for entry in runtime.nodes()])') == "['/ear']"
    pilot('page(v=1, w=0)\npilot.stop()\npilot.close()')
    assert 'This teleop has ended' in pilot('print(heard[-1] == (0.0, 0.0) and told[-1]["ended"])')


def test_two_drive_the_same_robot_with_one_node(pilot):
    pilot('page(v=1, w=0)\nwait_for((0.2, 0.0))\nfirst = pilot\npilot = lab.teleop(max_speed=0.1)')
    assert pilot('print([e.name for e in runtime.nodes()])') == "['/ear', '/teleop']"
    pilot('page(v=-1, w=0)\nwait_for((-0.1, 0.0))')
    # The end of one is not that of the other, which goes on to be heard.
    pilot('first.close()\nheard.clear()\npage(v=-0.5, w=0)\nwait_for((-0.05, 0.0))')
    pilot("first._widget._handle_custom_msg({'v': 1, 'w': 0}, [])\npage(stop=True)")
    pilot('wait_for((0.0, 0.0))')
    assert pilot('print((0.2, 0.0) in heard)') == 'False'
    topics = pilot('print([each.topic_name for each in pilot.node.publishers])')
    assert topics.count('/cmd_vel') == 1
    # Another name is another robot's.
    pilot("other = lab.teleop(namespace='robot1')\nprint(other.topic)")
    assert pilot('print([e.name for e in runtime.nodes()][1:])') == (
        "['/teleop', '/robot1/teleop']"
    )
    pilot('pilot.close()\nother.close()')
    assert pilot('print([e.name for e in runtime.nodes()])') == "['/ear']"


def test_a_new_way_does_not_wait_for_the_timer(pilot):
    pilot("""
from types import SimpleNamespace
lab.wait_until(lambda: pilot._publisher.get_subscription_count() == 1)
pilot.node.destroy_timer(pilot._repeat)
pilot._repeat = SimpleNamespace(reset=lambda: None)
for way in (0.1, 0.2, 0.3):
    page(v=way, w=0.0)
    page(v=way, w=0.0)
    wait_for((round(0.2 * way, 3), 0.0))
page(stop=True)
wait_for((0.0, 0.0))
""")
    # Only what is new: what is said again is left to the timer.
    assert pilot('print(heard)') == '[(0.02, 0.0), (0.04, 0.0), (0.06, 0.0), (0.0, 0.0)]'


def test_after_the_end_of_its_node_it_says_so(pilot):
    # At once, not when the page asks.
    pilot(SPY + "lab.remove('teleop')")
    assert 'The node of this teleop has ended' in pilot('print(told[-1]["ended"])')
    pilot('told.clear()\npage(v=1, w=0)\nlab.stop()\npage(view="there")')
    assert pilot('print(len(told), all("ended" in each for each in told))') == '2 True'


def test_end_of_ros_stops_the_robot_first(pilot):
    # Its last command is published while its node still is there.
    pilot(SPY + 'page(v=1, w=0)\nwait_for((0.2, 0.0))\nlab.stop()')
    assert pilot('print(pilot.published)') == '(0.0, 0.0)'
    assert 'ROS was stopped' in pilot('print(told[-1]["ended"])')


def test_page_that_is_closed_stops_the_robot(pilot):
    pilot("""
repeat = ear.create_timer(0.1, lambda: page(v=1, w=0))
wait_for((0.2, 0.0))
with runtime.executor.between_callbacks():
    ear.destroy_timer(repeat)
page(view='gone')
""")
    assert pilot('print(pilot.published)') == '(0.0, 0.0)'


def test_page_is_told_what_is_published_and_who_listens(pilot):
    pilot(SPY + 'page(view="seen")')
    known = eval(pilot('print(told[0])'))  # what this test has sent itself
    assert known['topic'] == '/cmd_vel' and known['speeds'] == [0.2, 2.0] and not known['note']
    pilot('page(v=1, w=0)\nlab.wait_until(lambda: any("published" in each for each in told))')
    news = eval(pilot('print(next(each for each in told if "published" in each))'))
    assert news['published'] in ((0.2, 0.0), (0.0, 0.0)) and news['count'] > 0
    pilot('lab.remove("ear")\ntold.clear()\npage(v=1, w=0)')
    pilot('lab.wait_until(lambda: any("Is the robot running" in e.get("note", "") for e in told))')
    # A robot that listens elsewhere is named.
    pilot('ear = lab.spin(Node("ear"))\near.create_subscription(Twist, "/r2/cmd_vel", print, 10)')
    words = "Somebody does on /r2/cmd_vel. Choose a robot: lab.teleop(namespace='r2')"
    pilot(f'lab.wait_until(lambda: any({words!r} in e.get("note", "") for e in told))')


def test_a_robot_that_takes_the_other_type_is_named_with_the_way_to_send_it(start_kernel):
    kernel = start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    kernel.run(PILOT)
    made = kernel.run(
        'import rclpy\nfrom geometry_msgs.msg import TwistStamped\n'
        'from rclpy.context import Context\n'
        'from labkit.background.notebook_rclpy import ORIGINALS\n'
        'lab.remove("ear")\nthere = Context()\n'
        'rclpy.init(context=there, domain_id=runtime.domain_id)  # as another process is\n'
        'far = Node("far", context=there)\n'
        'ORIGINALS["create_subscription"](far, TwistStamped, "/cmd_vel", print, 10)\n'
        'lab.wait_until(lambda: runtime.helper.count_subscribers("/cmd_vel"))'
    )
    assert not made.error, made.traceback
    kernel.run(SPY + 'page(view="seen")\npage(v=1, w=0)')
    words = (
        '/far listens on /cmd_vel to geometry_msgs/msg/TwistStamped. '
        'For that: lab.teleop(stamped=True)'
    )
    told = kernel.run(f'lab.wait_until(lambda: any(e.get("note", "") == {words!r} for e in told))')
    assert not told.error, told.traceback


def test_one_that_is_refused_leaves_nothing_behind(kernel):
    kernel.run('import labkit as lab\nrobot = lab.spin(lab.Turtlebot(stamped=True))')
    refused = kernel.run('lab.teleop()')
    assert '/turtlebot uses /cmd_vel with messages of another type' in refused.error
    assert 'For that: lab.teleop(stamped=True)' in refused.error
    assert '/teleop' not in kernel.run('print(lab.graph())').text
    # The right one drives.
    driven = kernel.run(
        'start = robot.pose\npilot = lab.teleop(stamped=True)\n'
        'pilot._widget._handle_custom_msg(dict(v=1, w=0), [])\n'
        'lab.wait_until(lambda: robot.pose != start, timeout_sec=20)'
    )
    assert not driven.error, driven.traceback


def test_headless_it_is_text(start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    kernel.run('import labkit as lab')
    data = kernel.run('lab.teleop()').outputs[0]['data']
    assert set(data) == {'text/plain'}
    assert 'w or ↑   forward' in data['text/plain']
    assert 'at first 100% of full speed: 0.22 m/s, 1.42 rad/s' in data['text/plain']


def test_speeds_that_make_no_sense_are_refused(kernel):
    kernel.run('import labkit as lab')
    for option in ('max_speed=0', 'max_turn=-1', "max_speed='fast'", 'max_turn=float("inf")'):
        assert 'must be a number above 0' in kernel.run(f'lab.teleop({option})').error
    assert 'teleop' not in kernel.run('lab.start()\nprint(lab.graph())').text
