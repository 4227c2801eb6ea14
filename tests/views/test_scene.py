"""The scene in a kernel: what it hears, tells, leaves out, and what a page gets of it."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree import ElementTree

import pytest

from tests.conftest import Result

STAGE = """
import labkit as lab
from geometry_msgs.msg import PoseStamped
from labkit.background.runtime import runtime
from rclpy.node import Node
from tf2_msgs.msg import TFMessage

robot = lab.spin(lab.Turtlebot())

class Page:
    # What a page would get, and what it would say.
    def __init__(self, view):
        self.widget, self.known, self.told, self.things = view._widget, {}, [], {}
        self.widget.send = self.take
        self.say(view='seen')

    def take(self, content, buffers=None):
        self.known.update(content)
        self.told.append(content)
        self.things.update(content.get('things', {}))
        self.things = {name: thing for name, thing in self.things.items() if thing}

    def say(self, **content):
        self.widget._handle_custom_msg(content, [])

    def wait(self, condition):
        lab.wait_until(lambda: condition(self), timeout_sec=20)

def put(child, parent, x=0.0, node=[]):
    from geometry_msgs.msg import TransformStamped
    from tf2_ros import StaticTransformBroadcaster
    node[:] = node or [lab.spin(Node('puts'))]
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    message.transform.translation.x, message.transform.rotation.w = x, 1.0
    StaticTransformBroadcaster(node[0]).sendTransform(message)

def send_goal(frame='odom'):
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.orientation.w = 1.0, 1.0
    publisher.publish(message)

EARS = 'sorted(each.topic_name for each in runtime.helper.subscriptions)'
"""
TOLD = """
A scene in the frame odom.
Robot at x = 0.00 m, y = 0.00 m.
Odometry /odom at x = 0.00 m, y = 0.00 m, z = 0.00 m.
Robot turtlebot3_burger, /robot_description: 10 links.
Laser /scan: 358 points, the nearest 1.81 m away, at -124°.
Frames: odom, base_footprint, base_link, base_scan, camera_link, caster_back_link, imu_link, \
wheel_left_link, wheel_right_link, camera_rgb_frame, camera_rgb_optical_frame.
""".strip()
GOAL = "node = lab.spin(Node('planner'))\npublisher = node.create_publisher({}, '{}', 10)"


def shown(result: Result) -> dict[str, str]:
    (output,) = result.outputs
    data: dict[str, str] = output['data']
    return data


def test_it_is_told_and_drawn_the_same_each_time(run_still: Callable[[str], Result]) -> None:
    before = run_still('print(eval(EARS))').text
    first = shown(run_still('lab.scene()'))
    assert first['text/plain'] == TOLD
    assert shown(run_still('lab.scene()')) == first
    names = {each.text for each in ElementTree.fromstring(first['image/svg+xml']).iter()}
    assert 'odom' in names
    # Nobody looks on, so it listens no more.
    assert run_still('print(eval(EARS))').text == before
    run_still('robot.place(x=0.4)')
    assert 'Robot at x = 0.40 m' in shown(run_still('lab.scene()'))['text/plain']


def test_in_another_frame_the_world_moves(run_still: Callable[[str], Result]) -> None:
    run_still('robot.place(x=0.4)')
    text = shown(run_still("lab.scene(fixed_frame='base_link')"))['text/plain']
    assert text.startswith('A scene in the frame base_link.\nRobot at x = 0.00 m, y = 0.00 m.')
    run_still(
        "here = lab.scene(fixed_frame='base_link'); there = lab.scene()\nrepr((here, there))"
    )
    far = run_still(
        "print(round(float((there.things['/scan points'].points"
        " - here.things['/scan points'].points)[:, 0].mean()), 2))"
    )
    assert far.text == '0.4\n'


def test_walls_of_the_simulator_are_there_if_they_are_asked_for(
    run_still: Callable[[str], Result],
) -> None:
    assert not run_still("print([n for n in lab.scene().things if 'wall' in n])").text.strip(
        '[]\n'
    )
    text = shown(run_still('lab.scene(world=robot)'))['text/plain']
    assert 'Of the simulator: 4 walls, 3 posts.' in text
    assert text == shown(run_still('lab.scene(world=robot.simulator.world)'))['text/plain']


def test_a_crate_is_drawn_where_it_was_pushed(run_still: Callable[[str], Result]) -> None:
    pytest.importorskip('mujoco')
    run_still(
        'import mujoco\n'
        'from labkit.sim.physics.mujoco_world import PhysicsWorld\n'
        'from labkit.sim.physics.things import Crate\n'
        'from labkit.sim.world import room\n'
        'world = PhysicsWorld(room(4.0, 4.0), crates=[Crate(0.5, 0.0, size=0.2)])\n'
        'pushed = lab.scene(world=world)\n'
        'def middle():\n'
        '    found = pushed.things\n'
        "    return round(sum(found[f'walls wall {n}'].place[0][0] for n in range(4, 8)) / 4, 3)"
    )
    room_side = "pushed.things['walls wall 0']"
    run_still(f'print(pushed); side = {room_side}')
    assert run_still('print(middle())').text == '0.5\n'
    run_still('world.data.qpos[0] = 1.2; mujoco.mj_forward(world.model, world.data)')
    # What stands is not sent again.
    assert run_still(f'print(middle(), {room_side} is side)').text == '1.2 True\n'


def test_what_tf2_does_not_know_is_named_with_its_reason_and_left_out(
    run_still: Callable[[str], Result],
) -> None:
    data = shown(run_still("lab.scene(fixed_frame='bse_link')"))
    # Once, and not for each frame and each topic.
    assert data['text/plain'].splitlines() == [
        'A scene in the frame bse_link.',
        'The scene can\'t be drawn in bse_link: "bse_link" passed to lookupTransform argument '
        "target_frame does not exist. Did you mean 'base_link'?",
    ]
    assert 'image/svg+xml' not in data
    run_still("put('shelf', 'map')")
    text = shown(run_still("lab.scene(fixed_frame='odom')"))['text/plain']
    assert (
        "Frame shelf can't be drawn in odom: Could not find a connection between 'odom' and "
        "'shelf' because they are not part of the same tree." in text
    )


def test_without_frames_it_says_what_to_do(run_still: Callable[[str], Result]) -> None:
    run_still('lab.remove(robot)')
    data = shown(run_still('lab.scene()'))
    assert data == {'text/plain': data['text/plain']}
    assert data['text/plain'].startswith('Nothing is there to be drawn: no transform was heard')
    assert 'lab.spin(lab.Turtlebot())' in data['text/plain']


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ("show='/scan'", 'show and hide are lists of names'),
        ('hide=[3]', 'show and hide are lists of names'),
        ('fixed_frame=3', 'frames are names'),
        ('world=3', 'world is a simulated world'),
    ],
)
def test_arguments_that_are_none_are_refused(kernel, arguments: str, words: str) -> None:
    result = kernel.run(f'import labkit as lab\nlab.scene({arguments})')
    assert words in result.traceback


def test_a_page_gets_all_and_then_what_is_new(run: Callable[[str], str]) -> None:
    run("view = lab.scene(follow='base_link')\npage = Page(view)")
    run("page.wait(lambda p: '/scan points' in p.things and len(p.known['frames']) == 11)")
    run('first, *_ = page.told; known = page.known')
    assert run("print(first['all'], first['follow'], known['fixed'], known['robots'])") == (
        "True base_link odom ['base_footprint']"
    )
    names = run("print(*sorted(page.things), sep='\\n')").splitlines()
    assert {
        '/robot_description base_link',
        '/robot_description wheel_left_link',
        '/odom head',
        '/scan points',
    } <= {*names}
    assert run("print(known['displays'])") == (
        "[['grid', True, ''], ['frames', True, ''], ['/camera/image_raw', False, ''], "
        "['/odom', True, ''], ['/robot_description', True, ''], ['/scan', True, '']]"
    )
    # A robot at rest is nothing new; one that drives is told by its frame alone.
    run('page.told.clear(); robot.place(x=0.3)')
    run("page.wait(lambda p: p.known['frames']['base_footprint'][0] == 0.3)")
    sent = run("print(*{n for c in page.told for n in c.get('things', {})}, sep='\\n')").split(
        '\n'
    )
    assert '/odom shaft' in sent
    assert '/robot_description base_link' not in sent
    run('view.close()')
    assert run('print([n for n in eval(EARS) if n in ("/tf", "/scan", "/odom")])') == '[]'


def test_a_display_that_is_off_is_not_heard(run: Callable[[str], str]) -> None:
    run("view = lab.scene(hide=['/scan', '/robot_description'])\npage = Page(view)")
    run("page.wait(lambda p: '/odom head' in p.things)")
    assert "'/scan'" not in run('print(eval(EARS))')
    run("page.say(display='/scan', on=True)\npage.say(display='/odom', on=False)")
    run("page.wait(lambda p: '/scan points' in p.things and '/odom head' not in p.things)")
    ears = run('print(eval(EARS))')
    assert "'/scan'" in ears
    assert "'/odom'" not in ears
    assert run("print([n for n in page.things if n.startswith('/robot_d')])") == '[]'
    run("page.say(display='/robot_description', on=True)")
    run("page.wait(lambda p: '/robot_description base_link' in p.things)")


def test_another_frame_is_chosen_in_the_page_and_nonsense_is_none(
    run: Callable[[str], str],
) -> None:
    run('robot.place(x=0.4)\nview = lab.scene()\npage = Page(view)')
    run("page.wait(lambda p: '/scan points' in p.things)")
    run("for wrong in ('moon', 3, None, ['odom']):\n    page.say(fixed=wrong)")
    run("page.say(display=3, on=True)\npage.say(display='/scan', on='no')")
    assert run('print(view.fixed_frame)') == 'odom'
    run("page.say(fixed='base_link')")
    run("page.wait(lambda p: p.known['fixed'] == 'base_link')")
    assert run("print(round(page.known['frames']['odom'][0], 2))") == '-0.4'


def test_a_goal_is_there_as_soon_as_it_is_set(run: Callable[[str], str]) -> None:
    run('view = lab.scene()\npage = Page(view)')
    run(GOAL.format('PoseStamped', 'goal_pose'))
    run("page.wait(lambda p: any(n == '/goal_pose' for n, *_ in p.known['displays']))")
    run('lab.wait_for_subscribers(publisher)\nsend_goal()')
    run("page.wait(lambda p: '/goal_pose head' in p.things)")
    assert run("print(page.things['/goal_pose head']['frame'])") == 'odom'
    run("send_goal('moon')")
    run("page.wait(lambda p: '/goal_pose head' not in p.things)")
    run("page.wait(lambda p: ['/goal_pose', True] in [one[:2] for one in p.known['displays']])")
    why = run("print([one[2] for one in page.known['displays'] if one[0] == '/goal_pose'][0])")
    assert why.startswith('/goal_pose can\'t be drawn in odom: "moon" passed to lookupTransform')
    run('lab.remove(node)')
    run("page.wait(lambda p: all(n != '/goal_pose' for n, *_ in p.known['displays']))")


def test_what_a_camera_sees_is_an_inset_while_it_is_on(run: Callable[[str], str]) -> None:
    run("view = lab.scene(hide=['/scan'])\npage = Page(view)")
    run("page.wait(lambda p: '/odom head' in p.things)")
    assert "'/camera/image_raw'" not in run('print(eval(EARS))')
    run("page.say(display='/camera/image_raw', on=True)")
    run("page.wait(lambda p: '/camera/image_raw' in p.known.get('pictures', {}))")
    assert 'Picture /camera/image_raw: 320 x 240 pixels, rgb8.' in run('print(view.text)')


def test_a_description_that_is_none_is_told_with_its_line(run: Callable[[str], str]) -> None:
    run("lab.remove(robot)\nfrom std_msgs.msg import String\nput('base', 'map')")
    run('view = lab.scene()\npage = Page(view)')
    run(GOAL.format('String', 'arm/robot_description'))
    run("lab.wait_for_subscribers(publisher)\npublisher.publish(String(data='<robot/>'))")
    run("page.wait(lambda p: any(one[2] for one in p.known['displays']))")
    why = run("print([one[2] for one in page.known['displays'] if one[2]][0])")
    assert why.startswith('/arm/robot_description: ')
    box = '<geometry><box size="1 1 1"/></geometry>'
    urdf = f'<robot name="r"><link name="base"><visual>{box}</visual></link></robot>'
    run(f"publisher.publish(String(data='{urdf}'))")
    run("page.wait(lambda p: '/arm/robot_description base' in p.things)")
    run("page.wait(lambda p: not any(one[2] for one in p.known['displays']))")
    assert run("print('arm at x = 0.00 m, y = 0.00 m.' in view.text)") == 'True'


def test_a_scan_waits_for_the_transforms_of_its_time(run: Callable[[str], str]) -> None:
    run("""
from labkit.views.scene_topics import ScanDisplay
from sensor_msgs.msg import LaserScan
view = lab.scene()
repr(view)
late = lab.wait_for_message('/scan', LaserScan)
frames = view._frames
frames.heard.node = runtime.helper
display = ScanDisplay('/other', is_on=True)
at = frames.heard.tree.latest_common_time('odom', 'base_scan')
late.header.stamp.sec, late.header.stamp.nanosec = divmod(at, 10**9)
""")
    run('display.take(late); first = display.things(frames, "odom")')
    assert run('print(list(first), frames.why)') == "['points'] {}"
    run('late.header.stamp.sec += 1; display.take(late)')
    # As long as it waits, the one before is there.
    assert run('print(display.things(frames, "odom") is first)') == 'True'
    # It does not wait for ever: then it is told, and not drawn.
    run('for _ in range(20): display.take(late)')
    assert run('print(display.things(frames, "odom"))') == '{}'
    assert 'Lookup would require extrapolation' in run('print(frames.why)')
