"""Service calls: repeated until an answer comes, and given up when none can come."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import GetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool

import labkit
from labkit.asking.parameter_calls import set_parameters
from labkit.asking.service_calls import ServiceCalls
from labkit.background.runtime import runtime
from labkit.errors import LabError, LabTimeout


class Lamp(Node):
    """A service that fails when switched on, and waits for `go_on` when switched off."""

    def __init__(self) -> None:
        super().__init__('lamp')
        self.calls = 0
        self.go_on = threading.Event()
        self.go_on.set()
        self.create_service(SetBool, 'switch', self.on_switch)
        self.declare_parameter('volts', 12)
        self.add_on_set_parameters_callback(self.on_set)

    def on_switch(self, request: Any, response: Any) -> Any:
        self.calls += 1
        if request.data:
            raise ValueError('no current')
        self.go_on.wait(60)
        response.success = True
        return response

    def on_set(self, parameters: list[Any]) -> SetParametersResult:
        raise ValueError('no current')


@pytest.fixture
def lamp() -> Iterator[Lamp]:
    labkit.start()
    lamp = labkit.spin(Lamp())
    yield lamp
    lamp.go_on.set()
    labkit.stop()


@pytest.fixture
def asker(lamp: Lamp) -> Node:
    assert runtime.helper is not None
    return runtime.helper


def test_no_answer_is_waited_for_from_a_callback_that_has_failed(lamp: Lamp, asker: Node) -> None:
    for _ in range(2):  # an error that is known is counted, not shown
        with ServiceCalls(asker, SetBool, '/switch') as service:
            service.wait_until_ready(60)
            with pytest.raises(LabError, match='on_switch of /lamp has failed') as caught:
                service.call(SetBool.Request(data=True), 60)
            assert not isinstance(caught.value, LabTimeout)
            assert service.call(SetBool.Request(data=False), 60).success
    parameter = Parameter('volts', value=5).to_parameter_msg()
    with pytest.raises(LabError, match='/lamp/set_parameters gives no answer'):
        set_parameters(asker, '/lamp', [parameter])


def test_what_may_be_done_twice_is_asked_again(
    lamp: Lamp, asker: Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ServiceCalls(asker, SetBool, '/switch') as service:
        service.wait_until_ready(60)
        assert service.call(SetBool.Request(data=False), 60).success
        assert lamp.calls == 1
        call_async, asked = service._client.call_async, 0

        def ask(request: Any) -> Any:
            nonlocal asked
            asked += 1
            if asked == 2:
                lamp.go_on.set()
            return call_async(request)

        monkeypatch.setattr(service._client, 'call_async', ask)
        lamp.go_on.clear()
        assert service.call(SetBool.Request(data=False), 60, again_sec=0.1).success
        labkit.wait_until(lambda: lamp.calls > 2, timeout_sec=60)


def test_a_node_that_is_not_spun_is_told(lamp: Lamp, asker: Node) -> None:
    idle = Node('idle')
    idle.create_service(SetBool, '/asleep', lamp.on_switch)
    with ServiceCalls(asker, SetBool, '/asleep') as service:
        service.wait_until_ready(60)
        with pytest.raises(LabTimeout, match='/idle is not spun'):
            service.call(SetBool.Request(), 0.1)
        with ServiceCalls(asker, GetParameters, '/idle/get_parameters') as every_node_has:
            every_node_has.wait_until_ready(60)
            with pytest.raises(LabTimeout, match='/idle is not spun'):
                every_node_has.call(GetParameters.Request(), 0.1)
        idle.destroy_node()
        with pytest.raises(LabTimeout, match='No node offers it any more'):
            service.call(SetBool.Request(), 0.1)


def test_a_node_that_takes_too_long_is_told(lamp: Lamp, asker: Node) -> None:
    with ServiceCalls(asker, SetBool, '/switch') as service:
        service.wait_until_ready(60)
        lamp.go_on.clear()
        with pytest.raises(LabTimeout, match=r'/switch did not answer within 0\.1 s'):
            service.call(SetBool.Request(data=False), 0.1)
