"""`ros2 service echo`: what a service with introspection tells."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

SERVER = """
import sys
import threading
import time

import labkit as lab
from labkit.ros2.shell import run_line
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState
from std_srvs.srv import SetBool


class Lamp(Node):
    def __init__(self):
        super().__init__('lamp')
        server = self.create_service(SetBool, 'switch', self.on_switch)
        server.configure_introspection(
            self.get_clock(), QoSProfile(depth=10), ServiceIntrospectionState.CONTENTS
        )
        self.create_service(SetBool, 'silent', self.on_switch)

    def on_switch(self, request, response):
        response.message = 'done'
        return response


lab.start()
lamp = Lamp()
lab.spin(lamp)


def call():
    lab.wait_until(lambda: lamp.count_subscribers('/switch/_service_event'), timeout_sec=30)
    run_line('service call /switch std_srvs/srv/SetBool "{data: true}"')
"""


def test_requests_and_responses_are_shown(script: Callable[..., Any]) -> None:
    result = script(
        SERVER
        + """
caller = threading.Thread(target=call)
caller.start()
run_line('service echo switch --count 2')
caller.join()
"""
    )
    assert result.exit_code == 0, result.stderr
    assert 'event_type: REQUEST_RECEIVED' in result.stdout
    assert 'event_type: RESPONSE_SENT' in result.stdout
    assert 'request:\n- data: true\n' in result.stdout and 'message: done' in result.stdout


def test_what_is_wrong_is_told(script: Callable[..., Any]) -> None:
    result = script(
        SERVER
        + """
print(run_line('service echo /silent --timeout 0.1'))
print(run_line('service echo /swich --timeout 0.1'))
print(run_line('service echo /switch --timeout 0.1'))
"""
    )
    assert "No publishers on topic '/silent/_service_event'" in result.stdout
    assert 'configure_introspection(' in result.stdout
    assert result.stdout.split()[-3:] == ['1', '1', '1'], result.stdout
    assert "Unknown service '/swich'\nDid you mean '/switch'?" in result.stderr
    assert 'No event came.' in result.stderr
