"""Events and event handlers of one's own, and events that programs are asked by.

What is said, and in which order, is as with the real launch.
"""

HEAD = """
import signal
from launch import LaunchDescription
from launch.actions import (
    EmitEvent, ExecuteProcess, LogInfo, OpaqueFunction, RegisterEventHandler,
)
from launch.event import Event
from launch.event_handler import BaseEventHandler, EventHandler
from launch.event_handlers import OnProcessExit, OnProcessStart, event_named
from launch.event_handlers.on_action_event_base import OnActionEventBase
from launch.events import matches_action
from launch.events.process import (
    ProcessExited, ShutdownProcess, SignalProcess, matches_executable, matches_name,
)
from launch.substitutions import LocalSubstitution
"""
OWN_EVENT = """
class Bell(Event):
    name = 'mine.Bell'

    def __init__(self, tone):
        self.tone = tone


class OnBell(BaseEventHandler):
    def __init__(self, tone, **kwargs):
        super().__init__(
            matcher=lambda event: isinstance(event, Bell) and event.tone == tone, **kwargs
        )

    def handle(self, event, context):
        super().handle(event, context)
        return [LogInfo(msg=['rings ', LocalSubstitution('event.tone'), ' ', event.name])]


def once(context):
    context.register_event_handler(EventHandler(
        matcher=event_named('mine.Bell'), entities=[LogInfo(msg='once')], handle_once=True))


def generate_launch_description():
    return LaunchDescription([
        RegisterEventHandler(OnBell('high')),
        RegisterEventHandler(EventHandler(
            matcher=lambda event: isinstance(event, Bell), entities=[LogInfo(msg='a bell')])),
        OpaqueFunction(function=once),
        EmitEvent(event=Bell('high')),
        EmitEvent(event=Bell('low')),
    ])
"""


def said(one) -> list[str]:
    return [line.partition(']: ')[2] for line in one.lines if 'launch.user' in line]


def test_an_event_and_handlers_of_ones_own(launch):
    one = launch(HEAD + OWN_EVENT)
    assert one.end() == 0, one.shown
    assert said(one) == ['once', 'a bell', 'rings high mine.Bell', 'a bell']


LIKE_ON_EXIT = """
class OnFailure(OnActionEventBase):
    def __init__(self, *, target_action=None, on_failure, **kwargs):
        super().__init__(
            action_matcher=target_action,
            on_event=on_failure,
            target_event_cls=ProcessExited,
            target_action_cls=ExecuteProcess,
            **kwargs,
        )

    def matches(self, event):
        return super().matches(event) and event.returncode != 0


def generate_launch_description():
    bad = ExecuteProcess(cmd=['false'])
    return LaunchDescription([
        RegisterEventHandler(OnFailure(on_failure=lambda event, context: LogInfo(
            msg=f'{event.process_name} {event.returncode} {event.cmd} {event.cwd}'))),
        ExecuteProcess(cmd=['true']),
        bad,
    ])
"""


def test_a_handler_of_ones_own_for_programs(launch):
    one = launch(HEAD + LIKE_ON_EXIT)
    assert one.end() == 0, one.shown
    assert said(one) == ["false-2 1 ['false'] None"]


ASKED = """
def generate_launch_description():
    first = ExecuteProcess(cmd=['sleep', '1000'], name='first')
    second = ExecuteProcess(cmd=['sleep', '1001'], name='second')
    third = ExecuteProcess(cmd=['sleep', '1002'], name='third', respawn=True)
    return LaunchDescription([
        first, second, third,
        RegisterEventHandler(OnProcessStart(target_action=third, on_start=[
            EmitEvent(event=SignalProcess(
                signal_number=signal.SIGUSR1, process_matcher=matches_action(first)))])),
        RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[
            EmitEvent(event=ShutdownProcess(process_matcher=matches_name('second-2')))])),
        RegisterEventHandler(OnProcessExit(target_action=second, on_exit=[
            EmitEvent(event=ShutdownProcess(process_matcher=matches_executable('sleep')))])),
    ])
"""


def test_programs_are_sent_signals_and_ended(launch):
    one = launch(HEAD + ASKED)
    assert one.end() == 0, one.shown
    sent = [line for line in one.shown.splitlines() if 'sending signal' in line]
    assert sent == [
        "[INFO] [first-1]: sending signal 'SIGUSR1' to process[first-1]",
        "[INFO] [second-2]: sending signal 'SIGINT' to process[second-2]",
        "[INFO] [third-3]: sending signal 'SIGINT' to process[third-3]",
    ]
    assert one.shown.count('process started') == 3, 'one that was asked to end does not respawn'


NO_SIGNAL = """
def generate_launch_description():
    return LaunchDescription([EmitEvent(event=SignalProcess(
        signal_number='SIGNOTHING', process_matcher=lambda action: True))])
"""


def test_a_signal_that_is_none_is_told_with_its_line(launch):
    one = launch(HEAD + NO_SIGNAL)
    assert one.end() == 1
    assert "signal_number is a signal, and this is 'SIGNOTHING'." in one.shown
