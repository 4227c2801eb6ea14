"""The process that launches: what it starts, shows, signals and leaves: nothing.

Texts, exit codes and the order of signals are those of the real `launch`.
"""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import TIMEOUT_SEC
from tests.launching.stage import Launched, write

# Each start and Ctrl-C at another moment; 200 of them take minutes.
COUNT = int(os.environ.get('LABKIT_TEST_LAUNCHES', '8'))


def xml(*body: str) -> str:
    return '\n'.join(['<launch>', *body, '</launch>'])


def test_prefixes_and_the_end(launch):
    one = launch(xml('<executable cmd="echo a" output="screen"/>', '<log message="b"/>'))
    assert one.end() == 0
    assert one.shown.splitlines() == [
        '[INFO] [launch.user]: b',
        '[INFO] [echo-1]: process started with pid [P]',
        '[echo-1] a',
        '[INFO] [echo-1]: process has finished cleanly [pid P]',
    ]


@pytest.mark.parametrize(
    ('output', 'seen'),
    [
        ('', ['err']),
        ('output="log"', ['err']),
        ('output="screen"', ['err', 'out']),
        ('output="both"', ['err', 'out']),
        ('output="own_log"', []),
        ('output="full"', ['err', 'out']),
    ],
)
def test_what_is_shown_and_what_is_logged(launch, tmp_path, output, seen):
    one = launch(xml(f'<executable cmd="sh -c \'echo out; echo err 1&gt;&amp;2\'" {output}/>'))
    one.end()
    marked = sorted(line.removeprefix('[sh-1] ') for line in one.lines if line[:6] == '[sh-1]')
    assert marked == seen
    (log,) = (tmp_path / 'log').rglob('launch.log')
    assert '[sh-1] out' in log.read_text() and '[sh-1] err' in log.read_text()


def test_a_program_that_dies(launch):
    one = launch(xml('<executable cmd="sh -c \'exit 3\'"/>', '<executable cmd="echo"/>'))
    assert one.end() == 0, 'what becomes of programs is not the exit code of the launch'
    assert (
        "[ERROR] [sh-1]: process has died [pid P, exit code 3, cmd 'sh -c exit 3']." in one.shown
    )


def test_ctrl_c_interrupts_all_of_them_once(launch):
    body = (
        "import signal, time; signal.signal(2, lambda *_: (print('interrupted'), exit(0)));"
        " print('here'); time.sleep(100)"
    )
    program = (
        f'<executable cmd="{sys.executable} -c &quot;{body}&quot;" name="p" output="screen"/>'
    )
    one = launch(xml(program, program))
    for _ in range(2):
        one.wait_for('here')
    one.send(signal.SIGINT)
    assert one.end() == 0
    assert one.lines.count('[p-1] interrupted') == one.lines.count('[p-2] interrupted') == 1
    assert '[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)' in one.lines
    assert "[INFO] [p-1]: sending signal 'SIGINT' to process[p-1]" in one.lines


def test_who_does_not_listen_is_terminated_then_killed(launch):
    waits = '<let name="sigterm_timeout" value="0.2"/><let name="sigkill_timeout" value="0.3"/>'
    script = "trap '' INT TERM; echo here; while true; do sleep 0.05; done"
    one = launch(xml(waits, f'<executable cmd="sh -c &quot;{script}&quot;" output="screen"/>'))
    one.wait_for('here')
    one.send(signal.SIGINT)
    assert one.end() == 0
    said = [line for line in one.shown.splitlines() if 'sh-1]: ' in line][1:]
    assert said == [
        "[INFO] [sh-1]: sending signal 'SIGINT' to process[sh-1]",
        "[ERROR] [sh-1]: process[sh-1] failed to terminate '0.2' seconds after receiving "
        "'SIGINT', escalating to 'SIGTERM'",
        "[INFO] [sh-1]: sending signal 'SIGTERM' to process[sh-1]",
        "[ERROR] [sh-1]: process[sh-1] failed to terminate '0.5' seconds after receiving "
        "'SIGTERM', escalating to 'SIGKILL'",
        "[INFO] [sh-1]: sending signal 'SIGKILL' to process[sh-1]",
        f"[ERROR] [sh-1]: process has died [pid P, exit code -9, cmd 'sh -c {script}'].",
    ]


def test_the_waits_are_those_of_the_real_one():
    from labkit.launching.execute import Start

    assert (Start.sigterm, Start.sigkill) == (5.0, 5.0)


def test_respawn_as_often_as_it_may(launch):
    options = 'respawn="true" respawn_max_retries="2" respawn_delay="0.01"'
    one = launch(xml(f'<executable cmd="sh -c \'exit 1\'" {options}/>'))
    assert one.end() == 0
    assert one.shown.count('[sh-1]: process started') == 3
    assert one.shown.count('[sh-1]: process has died') == 3


def test_ctrl_c_ends_respawning(launch):
    options = 'respawn="true" respawn_delay="0.01"'
    one = launch(xml(f'<executable cmd="sh -c \'sleep 0.01\'" {options}/>'))
    for _ in range(3):
        one.wait_for('process started')
    one.send(signal.SIGINT)
    assert one.end() == 0


def test_ctrl_c_during_a_long_wait_before_a_respawn(launch):
    one = launch(xml('<executable cmd="sh -c \'exit 1\'" respawn="true" respawn_delay="1000"/>'))
    one.wait_for('process has died')
    one.send(signal.SIGINT)
    assert one.end() == 0
    assert one.shown.count('process started') == 1


def test_on_exit_shutdown_ends_the_others(launch):
    one = launch(
        xml('<executable cmd="echo" on_exit="shutdown"/>', '<executable cmd="sleep 1000"/>')
    )
    assert one.end() == 0
    required = '[INFO] [launch]: process[echo-1] was required: shutting down launched system'
    assert required in one.lines
    assert "exit code -2, cmd 'sleep 1000'" in one.shown


def test_timers(launch):
    one = launch(
        xml(
            '<timer period="0.05"><log message="second"/><executable cmd="echo"/></timer>',
            '<log message="first"/>',
            '<timer period="0.01"><timer period="0.01"><log message="inner"/></timer></timer>',
            '<ros_timer period="0.01"><log message="third"/></ros_timer>',
        )
    )
    assert one.end() == 0
    said = [line.rpartition(' ')[2] for line in one.lines if 'launch.user' in line]
    assert said[0] == 'first' and sorted(said[1:]) == ['inner', 'second', 'third']
    assert '[echo-1]: process has finished cleanly' in one.shown


def test_what_is_in_a_timer_has_the_configurations_of_its_place(launch):
    one = launch(
        xml(
            '<let name="a" value="outer"/>',
            '<group>',
            '<let name="a" value="inner"/><push_ros_namespace namespace="r1"/>',
            '<timer period="0.01"><log message="$(var a) $(var ros_namespace)"/>',
            '<let name="a" value="changed"/></timer>',
            '</group>',
            '<timer period="0.2"><log message="$(var a)"/></timer>',
            '<let name="a" value="later"/>',
        )
    )
    assert one.end() == 0, one.shown
    said = [line.partition(']: ')[2] for line in one.lines if 'launch.user' in line]
    assert said == ['inner /r1', 'outer']


def test_shutdown_cancels_timers(launch):
    one = launch(
        xml('<timer period="1000"><log message="never"/></timer>', '<shutdown reason="enough"/>')
    )
    assert one.end() == 0
    assert 'never' not in one.shown


EVENTS = """
from launch import LaunchDescription
from launch.actions import EmitEvent, ExecuteProcess, LogInfo, RegisterEventHandler, TimerAction
from launch.event_handlers import (
    OnExecutionComplete, OnProcessExit, OnProcessIO, OnProcessStart, OnShutdown,
)
from launch.events import Shutdown
from launch.substitutions import LocalSubstitution


def generate_launch_description():
    first = ExecuteProcess(cmd=['echo', 'hello'], name='first')
    second = ExecuteProcess(cmd=['sleep', '1000'], name='second')
    return LaunchDescription([
        RegisterEventHandler(OnProcessStart(target_action=first, on_start=[LogInfo(msg='began')])),
        RegisterEventHandler(OnProcessIO(
            target_action=first,
            on_stdout=lambda event: LogInfo(msg=f'said {event.text.decode().strip()}'))),
        RegisterEventHandler(OnProcessExit(
            target_action=first,
            on_exit=lambda event, context: [LogInfo(msg=f'code {event.returncode}'), second])),
        RegisterEventHandler(OnExecutionComplete(
            target_action=first, on_completion=[LogInfo(msg='complete')])),
        RegisterEventHandler(OnProcessStart(
            target_action=second, on_start=[EmitEvent(event=Shutdown(reason='seen'))])),
        RegisterEventHandler(OnShutdown(
            on_shutdown=[LogInfo(msg=['because ', LocalSubstitution('event.reason')])])),
        first,
    ])
"""


def test_event_handlers_of_a_python_file(launch):
    one = launch(EVENTS)
    assert one.end() == 0, one.shown
    said = [line.partition(']: ')[2] for line in one.lines if 'launch.user' in line]
    assert said == ['began', 'said hello', 'code 0', 'because seen', 'complete']


@pytest.mark.parametrize(
    'late',
    [
        '<timer period="1000"><node pkg="lab_none" exec="a"/></timer>',
        '<timer period="1000"><timer period="1"><log message="$(var nope)"/></timer></timer>',
        '<timer period="1000"><include file="nowhere.launch.xml"/></timer>',
    ],
)
def test_a_fault_in_what_comes_late_is_told_before_anything_starts(launch, late):
    one = launch(xml('<executable cmd="echo"/>', late))
    assert one.end() == 1
    assert 'main.launch.xml, line 3: ' in one.shown
    assert 'process started' not in one.shown


def test_a_function_that_fails_late_ends_the_launch(launch):
    one = launch(
        'from launch import LaunchDescription\n'
        'from launch.actions import ExecuteProcess, OpaqueFunction, TimerAction\n'
        'def broken(context):\n    raise ValueError("of its own")\n'
        'def generate_launch_description():\n'
        "    return LaunchDescription([ExecuteProcess(cmd=['sleep', '1000']), TimerAction(\n"
        '        period=0.01, actions=[OpaqueFunction(function=broken)])])\n'
    )
    assert one.end() == 1
    (told,) = [line for line in one.lines if 'Caught exception in launch: ' in line]
    assert told.endswith('main.launch.py, line 4: ValueError: of its own')


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGHUP])
def test_other_signals_end_all_of_it_too(launch, number):
    one = launch(xml('<executable cmd="sleep 1000"/>'))
    one.wait_for('process started')
    one.send(number)
    assert one.end() == -number, 'as the real one, which handles neither'
    assert one.left == []


def test_kill_leaves_nothing(launch):
    one = launch(xml('<executable cmd="sleep 1000"/>'))
    one.wait_for('process started')
    one.send(signal.SIGKILL)
    assert one.end() == -9


def test_what_a_program_leaves_behind_is_ended(launch):
    one = launch(xml('<executable cmd="sh -c \'sleep 1000 &amp; echo\'" output="screen"/>'))
    assert one.end() == 0
    assert one.left == []


@pytest.mark.slow('starts many launches')
def test_starts_and_ctrl_cs_leave_no_process(launch):
    program = '<executable cmd="sh -c \'sleep 1000; true\'"/>'
    body = [program] * 5
    for number in range(COUNT):
        one = launch(xml(*body))
        for _ in range(number % 6):
            one.wait_for('process started')
        one.send(signal.SIGINT)
        code = one.end()
        # Before its handler is there, Ctrl-C ends Python itself: it has started nothing yet.
        too_early = number % 6 == 0 and 'process started' not in one.shown
        assert code == 0 or too_early, (code, one.shown)
        assert one.left == []


MANY = """\
import os, signal
from launch import LaunchDescription
from launch.actions import ExecuteProcess, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessStart

def interrupt(context):
    os.kill(os.getpid(), signal.SIGINT)

def generate_launch_description():
    first, *others = [ExecuteProcess(cmd=['sleep', '1000']) for _ in range(100)]
    start = OnProcessStart(target_action=first, on_start=[OpaqueFunction(function=interrupt)])
    return LaunchDescription([RegisterEventHandler(start), first, *others])
"""


def test_ctrl_c_is_heard_while_many_are_being_started(launch):
    one = launch(MANY)
    assert one.end() == 0
    assert one.left == []
    assert one.shown.count('process started') == 1
    assert 'process started' not in one.shown.partition('user interrupted')[2]


def test_a_program_gets_its_parameters_in_a_file_that_goes_with_the_launch(
    tmp_path, toys_prefix, monkeypatch
):
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(toys_prefix), prepend=':')
    script = toys_prefix / 'lib/toys/show'
    script.write_text('#!/bin/sh\necho "path $3"\ncat "$3"\n')
    script.chmod(0o755)
    node = '<node pkg="toys" exec="show" output="screen"><param name="a" value="1"/></node>'
    one = Launched(write(tmp_path, {'main.launch.xml': xml(node)}))
    assert one.end() == 0
    assert '[show-1]     a: 1' in one.lines
    (path,) = [line.split()[-1] for line in one.lines if 'path ' in line]
    assert not Path(path).exists()


@pytest.mark.parametrize(
    ('words', 'code', 'shown'),
    [
        (['main.launch.xml', 'a:=2'], 0, 'a is 2'),
        (['main.launch.xml', 'a=2'], 1, "malformed launch argument 'a=2'"),
        (['main.launch.xm'], 1, "Did you mean 'main.launch.xml'?"),
        (['toys'], 1, 'There is no launch file'),
        (['toys', 'toy.launch.xml'], 1, "Did you mean 'toys.launch.xml'?"),
        (['toys', 'toys.launch.xml'], 0, ''),
        (['lab_none', 'a.launch.xml'], 1, "Package 'lab_none' not found"),
        (['--show-args', 'main.launch.xml'], 0, "    'a':\n        no description given"),
        (['-s', 'main.launch.xml'], 0, "        (default: '1')"),
        (['-p', 'main.launch.xml'], 0, "├── DeclareLaunchArgument('a')"),
        (['--debug', 'main.launch.xml'], 0, '[DEBUG] [launch]: processing event: Shutdown'),
        (['-h'], 0, 'Run a launch file'),
    ],
)
def test_the_command_line(words, code, shown, tmp_path, toys_prefix, monkeypatch):
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(toys_prefix), prepend=':')
    body = '<arg name="a" default="1"/><log message="a is $(var a)"/>'
    write(tmp_path, {'main.launch.xml': xml(body)})
    done = subprocess.run(
        [sys.executable, '-m', 'labkit.ros2', 'launch', *words],
        cwd=tmp_path,
        env={**os.environ, 'ROS_DOMAIN_ID': '0', 'ROS_LOG_DIR': str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_SEC,
    )
    assert (done.returncode, shown in done.stdout + done.stderr) == (code, True), done


def test_a_line_of_the_log_folder_is_shown(launch, tmp_path):
    one = launch(xml('<log message="$(log_dir)"/>'))
    one.end()
    first, second = one.lines
    assert first.removeprefix('[INFO] [launch]: All log files can be found below ') == (
        second.removeprefix('[INFO] [launch.user]: ')
    )
