"""Why a robot stands that its command timeout has stopped: card, monitor and arena tell it."""

from __future__ import annotations

import pytest

STAGE = """
import labkit as lab
from geometry_msgs.msg import Twist
from rclpy.node import Node

robot = lab.spin(lab.Turtlebot(namespace='robot1', command_timeout=0.2))
pilot = lab.spin(Node('pilot'))
commands = pilot.create_publisher(Twist, '/robot1/cmd_vel', 10)
lab.wait_for_subscribers(commands)

def drive(v):
    message = Twist()
    message.linear.x = v
    commands.publish(message)

def stop():
    drive(0.2)
    lab.wait_until(lambda: robot.timed_out and robot.twist == (0.0, 0.0))

def told_to_stop():
    drive(0.0)
    lab.wait_until(lambda: not robot.timed_out)

class Page:
    # What a page would get, and what it would say.
    def __init__(self, view):
        self.known = {}
        view._widget.send = lambda content, buffers=None: self.known.update(content)
        view._widget._handle_custom_msg({'view': 'seen'}, [])

    def wait(self, key, words, there=True):
        lab.wait_until(lambda: (words in self.known.get(key, '')) == there, timeout_sec=20)
"""
WHY = 'stands: no command for 0.2 s; its time limit for commands has stopped it.'


def test_the_card_tells_it(run) -> None:
    assert 'It runs in the background. It stops 0.2 s after the last command.' in run('robot')
    run('stop()')
    assert f'It runs in the background. It {WHY}' in ' '.join(run('robot').split())
    other = run('lab.spin(lab.Turtlebot(command_timeout=None))')
    assert 'It runs in the background. It keeps its last velocity.' in other
    stepped = run('lab.spin(lab.Turtlebot(lockstep=0.1))')
    assert 'It runs in the background.\n' in stepped


def test_the_arena_tells_it(run) -> None:
    run('stop()')
    assert f'heading 0°. It {WHY} Nearest obstacle' in run('print(lab.arena())')
    run('page = Page(lab.arena())')
    run(f'page.wait("text", "It {WHY}")')
    run('told_to_stop()')
    run('page.wait("text", "It stands. Nearest")')
    assert 'It stands. Nearest' in run('print(lab.arena())')


@pytest.mark.parametrize('topic', ['cmd_vel', 'odom'])
def test_the_monitor_tells_it(run, topic: str) -> None:
    run(f'stop()\npage = Page(lab.monitor("/robot1/{topic}"))')
    run(f'page.wait("note", "The robot {WHY}")')
    run('told_to_stop()')
    run('page.wait("note", "The robot stands", there=False)')
    # And other topics of it say nothing.
    run('stop()')
    assert 'stands' not in run('print(lab.monitor("/robot1/scan"))')


@pytest.mark.slow('waits in real time')
def test_without_a_page_the_monitor_tells_it_too(run_still) -> None:
    run_still('stop()')
    assert run_still('print(lab.monitor("/robot1/odom"))').text.endswith(f'The robot {WHY}\n')
    run_still('told_to_stop()')
    assert 'stands' not in run_still('print(lab.monitor("/robot1/odom"))').text


@pytest.mark.slow('it waits twice for messages that do not come')
def test_no_cause_is_guessed_where_one_is_known(run) -> None:
    run('stop()')
    known = 'nothing came from it in that time. It has published before. The robot stands'
    assert known in run('print(lab.monitor("/robot1/cmd_vel"))')
    # As by another process, of which nothing is counted here.
    run(
        'lab.remove(pilot)\npilot = lab.spin(Node("pilot"))\n'
        'commands = pilot.create_publisher(Twist, "/robot1/cmd_vel", 10)\n'
        'lab.wait_for_subscribers(commands)\ncommand = Twist()\ncommand.linear.x = 0.2\n'
        'with commands.handle:\n    commands.handle.publish(command)'
    )
    shown = run('lab.wait_until(lambda: robot.timed_out)\nprint(lab.monitor("/robot1/cmd_vel"))')
    assert 'nothing came from it in that time. The robot stands' in shown


@pytest.mark.slow('waits in real time')
def test_one_that_is_gone_tells_nothing(run) -> None:
    run('stop()\npage = Page(lab.monitor("/robot1/odom"))')
    run(f'page.wait("note", "The robot {WHY}")')
    run('lab.remove(robot)')
    run('page.wait("note", "The robot stands", there=False)')
