"""The live picture of the graph: what it tells a page, and when it counts what passes."""

from __future__ import annotations

import pytest

STAGE = """
import labkit as lab
from labkit.asking import traffic
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

class Talker(Node):
    def __init__(self, name='talker'):
        super().__init__(name)
        self.publisher = self.create_publisher(String, 'chatter', 10)

    def say(self, times=1):
        for _ in range(times):
            self.publisher.publish(String(data='hello'))

class Listener(Node):
    def __init__(self, name='listener'):
        super().__init__(name)
        self.create_subscription(String, 'chatter', lambda msg: None, 10)

class Page:
    # What a page would get, and what it would say.
    def __init__(self, view):
        self.widget, self.known, self.passed = view._widget, {}, {}
        self.widget.send = self.take
        self.say(view='seen')
        self.say(visible=True, width=900)

    def take(self, content, buffers=None):
        self.known.update(content)
        for part, count in content.get('passed', {}).items():
            name = self.known['parts'][part][0]
            self.passed[name] = self.passed.get(name, 0) + count

    def say(self, **content):
        self.widget._handle_custom_msg(content, [])

    def wait(self, condition):
        lab.wait_until(lambda: condition(self.known), timeout_sec=20)

    def parts(self):
        return [lines[0] for lines in self.known['parts'].values()]
"""


@pytest.mark.slow('waits in real time')
def test_follows_what_comes_and_goes(run):
    run('view = lab.graph()\npage = Page(view)')
    assert run('print(page.known["svg"] == "", page.known["changed"])') == 'True False'
    # A node is in the graph before its publisher is.
    run('talker = lab.spin(Talker())')
    run('page.wait(lambda known: "/talker → /chatter" in known["told"])')
    assert run('print(page.known["changed"], page.known["told"])') == (
        'True Nodes: /talker. /talker → /chatter [std_msgs/msg/String].'
    )
    assert run('print(view)').startswith('Nodes:\n  /talker\nTopics:')
    run('lab.remove("talker")\npage.wait(lambda known: not known["svg"])')
    assert run('print(page.known["changed"], view)').startswith('False No node is running.')


def test_shows_how_it_was_when_the_cell_was_run(run):
    run('lab.spin(Talker())\npage = Page(lab.graph())\nlab.spin(Listener())')
    run('page.wait(lambda known: known["changed"])')
    run('page.say(then=True)')
    assert run('print(page.known["then"], "/listener" in page.known["svg"])') == 'True False'
    run('page.say(then=False)')
    assert run('print(page.known["then"], "/listener" in page.known["svg"])') == 'False True'


def test_tells_of_each_part_what_it_is(run):
    run('from rclpy.qos import qos_profile_sensor_data')
    run('lab.spin(Talker())\nlab.spin(Listener())\nlab.spin(Node("alone"))')
    run('lab.spin(Node("sonar")).create_publisher(String, "chatter", qos_profile_sensor_data)')
    run('page = Page(lab.graph())\nprint(*page.known["parts"].values(), sep="\\n")')
    # The watch tells of the fault some time later, in lines of its own.
    run('own = lambda part: [line for line in part if line[0] not in "⚠→"]')
    told = run('print(*sorted(map(own, page.known["parts"].values())), sep="\\n")').splitlines()
    assert told == [
        "['/listener hears nothing of /sonar on /chatter', "
        "'Best effort publisher and reliable subscription', 'Give the subscription of /listener "
        "reliability BEST_EFFORT, or the publisher of /sonar RELIABLE.']",
        "['/listener subscribes to /chatter', 'std_msgs/msg/String, reliable, volatile']",
        "['/sonar publishes on /chatter', 'std_msgs/msg/String, best effort, volatile']",
        "['/talker publishes on /chatter', 'std_msgs/msg/String, reliable, volatile']",
        "['Node /alone', 'It neither publishes nor subscribes']",
        "['Node /listener', 'Subscribes to: /chatter']",
        "['Node /sonar', 'Publishes: /chatter']",
        "['Node /talker', 'Publishes: /chatter']",
        "['Topic /chatter', 'Type: std_msgs/msg/String', 'Published by: /sonar, /talker', "
        "'Subscribed by: /listener']",
    ]


@pytest.mark.slow('waits in real time')
def test_tells_which_messages_pass_and_how_often(run):
    run('talker = lab.spin(Talker())\nlab.spin(Listener())\npage = Page(lab.graph())')
    run('talker.say(5)')
    both = '{"/talker publishes on /chatter": 5, "/listener subscribes to /chatter": 5}'
    run(f'lab.wait_until(lambda: page.passed == {both}, timeout_sec=20)')
    run('timer = talker.create_timer(0.05, talker.say)')
    run('page.wait(lambda known: len([r for r in known.get("rates", {}).values() if r]) == 2)')
    assert (
        run('print(all(rate.endswith(" Hz") for rate in page.known["rates"].values()))') == 'True'
    )
    run('timer.cancel()\npage.wait(lambda known: not any(known["rates"].values()))')


def test_counts_only_while_it_is_seen(run):
    run('talker = lab.spin(Talker())\nview = lab.graph()')
    assert run('print(len(traffic._open))') == '0'
    run('page = Page(view)')
    assert run('print(len(traffic._open))') == '1'
    run('page.say(visible=False)\ntalker.say()')
    assert run('print(len(traffic._open), page.passed)') == '0 {}'
    # Who looks away and comes back is not told what has passed meanwhile.
    run('page.say(visible=True)\ntalker.say(2)')
    run('lab.wait_until(lambda: sum(page.passed.values()) >= 2)')
    assert run('print(page.passed)') == "{'/talker publishes on /chatter': 2}"
    for end in ('page.say(view="gone")', 'page.say(view="there")\nview.close()'):
        run(end)
        assert run('print(len(traffic._open))') == '0'


def test_services_and_actions_are_offered_where_there_are_any(run):
    run('talker = lab.spin(Talker())\npage = Page(lab.graph())')
    assert run('print(page.known["switches"])') == '{}'
    run('talker.create_service(Trigger, "fire", lambda request, response: response)')
    run('page.wait(lambda known: known["switches"] == {"services": False})')
    assert run('print("/fire" in page.known["svg"])') == 'False'
    run('page.say(services=True)')
    assert run('print("/fire" in page.known["svg"], page.known["switches"])') == (
        "True {'services': True}"
    )
    assert 'Service /fire' in run('print(page.parts())')


def test_a_namespace_is_folded_and_messages_still_pass(run):
    run('class Robot(Node):\n    def __init__(self, name): super().__init__(name, namespace="a")')
    run('one, two = lab.spin(Robot("one")), lab.spin(Robot("two"))\nlab.spin(Listener())')
    run('say = [node.create_publisher(String, "/chatter", 10) for node in (one, two)]')
    run('page = Page(lab.graph())\npage.wait(lambda known: known["switches"])')
    assert run('print(page.known["switches"])') == "{'fold /a': False}"
    run('page.say(**{"fold /a": True, "fold /b": True})')
    told = run('print(*sorted(page.known["parts"].values()), page.known["switches"], sep="\\n")')
    assert told.splitlines() == [
        "['/a/* publishes on /chatter', 'std_msgs/msg/String, reliable, volatile']",
        "['/listener subscribes to /chatter', 'std_msgs/msg/String, reliable, volatile']",
        "['Namespace /a', 'Nodes: /a/one, /a/two', 'Publishes: /chatter']",
        "['Node /listener', 'Subscribes to: /chatter']",
        "['Topic /chatter', 'Type: std_msgs/msg/String', 'Published by: /a/*', "
        "'Subscribed by: /listener']",
        "{'fold /a': True}",
    ]
    run('[each.publish(String()) for each in say]')
    both = '{"/a/* publishes on /chatter": 2, "/listener subscribes to /chatter": 2}'
    run(f'lab.wait_until(lambda: page.passed == {both}, timeout_sec=20)')
    # With one node less there is nothing to fold.
    run('lab.remove("/a/two")\npage.wait(lambda known: not known["switches"])')
    assert run('print("/a/one" in page.known["svg"])') == 'True'


def test_a_node_tells_its_parameters_when_it_is_asked(run):
    run('talker = lab.spin(Talker())\ntalker.declare_parameter("speed", 0.5)')
    run('idle = Node("idle")\npage = Page(lab.graph())')
    run('told = lambda name: page.wait(lambda known: name in known.get("parameters", {}))')
    run('page.say(ask="/talker")\ntold("/talker")')
    assert run('print(page.known["parameters"]["/talker"])') == (
        'speed = 0.5, start_type_description_service = True, use_sim_time = False'
    )
    run('page.say(ask="/idle")\ntold("/idle")')
    assert 'use_sim_time' in run('print(page.known["parameters"]["/idle"])')
    # Whatever a page asks for.
    run('page.say(ask="/nobody")\npage.say(ask=[])\npage.say(ask="")')
    assert run('print(sorted(page.known["parameters"]))') == "['/idle']"


def test_a_narrow_page_gets_a_narrow_picture(run):
    run('lab.spin(Talker())\nlab.spin(Listener())\npage = Page(lab.graph())')
    width = 'import re\nprint(re.search(r\'width="(\\d+)"\', page.known["svg"])[1])'
    assert int(run(width)) > 400
    run('page.say(width=360)')
    assert int(run(width)) <= 360
    # Whatever a page says.
    for said in ('width=float("nan")', 'width=-5', 'services="x", then=[]'):
        run(f'page.say({said})')
        assert int(run(width)) > 0


def test_what_was_stored_is_a_picture(run):
    run('lab.spin(Talker())\nview = lab.graph()')
    kinds = run('print(sorted(view._static()))')
    assert kinds == "['image/svg+xml', 'text/plain']"
    run('still = lab.graph(live=False)\nlab.remove("talker")')
    assert run('print(still)').startswith('Nodes:\n  /talker')
    assert run('print(view)').startswith('No node is running.')


def test_after_the_end_of_ros_it_is_what_it_was(run):
    run('lab.spin(Talker())\nview = lab.graph()\npage = Page(view)\nlab.stop()')
    assert run('print(page.known["ended"])') == (
        'ROS was stopped. Run this cell to start it again.'
    )
    assert run('print(view)').startswith('Nodes:\n  /talker')
    assert run('print(len(traffic._open), runtime.started)') == '0 False'


def test_a_look_does_not_start_ros_again(run):
    # Nothing tells a view that no page has shown yet.
    run('lab.spin(Talker())\nview = lab.graph()\nlab.stop()\nview._ended = ""')
    assert run('print(view)').startswith('Nodes:\n  /talker')
    run('view._update(True)')
    assert run('print(runtime.started)') == 'False'
