"""`ros2 node`, `ros2 topic list|info|type|find` and `ros2 service` against foreign nodes."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.usefixtures('robot')

PARAMETER_SERVICES = [
    '/lamp/describe_parameters: rcl_interfaces/srv/DescribeParameters',
    '/lamp/get_parameter_types: rcl_interfaces/srv/GetParameterTypes',
    '/lamp/get_parameters: rcl_interfaces/srv/GetParameters',
    '/lamp/get_type_description: type_description_interfaces/srv/GetTypeDescription',
    '/lamp/list_parameters: rcl_interfaces/srv/ListParameters',
    '/lamp/set_parameters: rcl_interfaces/srv/SetParameters',
    '/lamp/set_parameters_atomically: rcl_interfaces/srv/SetParametersAtomically',
]


@pytest.mark.slow('starts other processes')
def test_nodes(ros2):
    shown, every, count, info, hidden, wrong = ros2(
        'node list',
        'node list --all',
        'node list -c',
        'node info /lamp',
        'node info /_hidden --include-hidden',
        'node info lamp',
    )
    assert shown.lines == ['/fleet/robot', '/lamp']
    assert [name for name in every.lines if 'labkit' not in name] == [
        *('/_hidden', '/fleet/robot', '/lamp')
    ]
    assert count.out == '2\n'
    assert info.lines == [
        '/lamp',
        '  Subscribers:',
        '',
        '  Publishers:',
        '    /parameter_events: rcl_interfaces/msg/ParameterEvent',
        '    /rosout: rcl_interfaces/msg/Log',
        '  Service Servers:',
        *(f'    {line}' for line in PARAMETER_SERVICES),
        '    /switch: std_srvs/srv/SetBool',
        '  Service Clients:',
        '',
        '  Action Servers:',
        '',
        '  Action Clients:',
        '',
    ]
    assert '    /_secret: std_msgs/msg/String' in hidden.lines
    assert (wrong.code, wrong.out) == (1, '')
    assert wrong.err == "Unable to find node 'lamp'\nDid you mean '/lamp'?\n"


def test_topics(ros2):
    names = ['/chatter', '/cmd_vel', '/heard', '/odds', '/odom', '/parameter_events']
    names += ['/rosout', '/scan']
    shown, types, every, count, found, kind, wrong = ros2(
        'topic list',
        'topic list -t',
        'topic --include-hidden-topics list',
        'topic list --count-topics',
        'topic find std_msgs/msg/String',
        'topic type /odom',
        'topic type /odon',
    )
    assert shown.lines == names
    assert '/odom [nav_msgs/msg/Odometry]' in types.lines
    assert every.lines == ['/_secret', *names]
    assert count.out == '8\n'
    assert found.lines == ['/chatter', '/heard']
    assert kind.out == 'nav_msgs/msg/Odometry\n'
    assert (wrong.code, wrong.err) == (1, "Unknown topic '/odon'\nDid you mean '/odom'?\n")


@pytest.mark.slow('starts other processes')
def test_topic_details(ros2):
    info, ends, wrong, verbose = ros2(
        'topic info /chatter', 'topic info /odds -v', 'topic info /chater', 'topic list -v'
    )
    assert info.lines == [
        *('Type: std_msgs/msg/String', 'Publisher count: 1', 'Subscription count: 0')
    ]
    lines = [line for line in ends.lines if not line.startswith(('GID', 'Topic type hash'))]
    assert lines == [
        'Type: std_msgs/msg/Int16',
        '',
        'Publisher count: 0',
        '',
        'Subscription count: 1',
        '',
        'Node name: robot',
        'Node namespace: /fleet',
        'Topic type: std_msgs/msg/Int16',
        'Endpoint type: SUBSCRIPTION',
        'QoS profile:',
        '  Reliability: RELIABLE',
        '  History (Depth): UNKNOWN',
        '  Durability: VOLATILE',
        '  Lifespan: Infinite',
        '  Deadline: Infinite',
        '  Liveliness: AUTOMATIC',
        '  Liveliness lease duration: Infinite',
        '',
    ]
    assert wrong.err == "Unknown topic '/chater'\nDid you mean '/chatter'?\n"
    assert verbose.lines[0] == 'Published topics:'
    assert ' * /chatter [std_msgs/msg/String] 1 publisher' in verbose.lines
    assert ' * /odds [std_msgs/msg/Int16] 1 subscriber' in verbose.lines


@pytest.mark.slow('starts other processes')
def test_services(ros2):
    shown, types, kind, found, info, count, wrong = ros2(
        'service list',
        'service list -t',
        'service type /switch',
        'service find std_srvs/srv/SetBool',
        'service info /switch',
        'service find -c rcl_interfaces/srv/GetParameters',
        'service type /swich',
    )
    assert '/switch' in shown.lines and '/lamp/get_parameters' in shown.lines
    assert not [name for name in shown.lines if '/_' in name]
    assert '/switch [std_srvs/srv/SetBool]' in types.lines
    assert kind.out == 'std_srvs/srv/SetBool\n'
    assert found.out == '/switch\n'
    assert info.lines == [*('Type: std_srvs/srv/SetBool', 'Clients count: 0', 'Services count: 1')]
    assert count.out == '2\n'
    assert wrong.err == "Unknown service '/swich'\nDid you mean '/switch'?\n"


def test_service_call(ros2):
    first, answer, wrong, other, empty, number = ros2(
        'service call /switch std_srvs/srv/SetBool "{data: true}"',
        'service call /switch std_srvs/srv/SetBool "{data: true}"',
        'service call /switch std_srvs/srv/SetBool "{dat: true}"',
        'service call /switch std_srvs/srv/Trigger',
        'service call /switch std_srvs/srv/SetBool ""',
        'service call /switch std_srvs/srv/SetBool 5',
    )
    assert answer.out == (
        'requester: making request: std_srvs.srv.SetBool_Request(data=True)\n\n'
        "response:\nstd_srvs.srv.SetBool_Response(success=True, message='on')\n\n"
    )
    # A process that has only just come knows of no service, as with each call of the real one.
    assert first.out == f'waiting for service to become available...\n{answer.out}'
    assert (wrong.code, wrong.err) == (
        1,
        "Failed to populate field: std_srvs/srv/SetBool_Request has no field 'dat'.\n"
        "Did you mean 'data'?\n",
    )
    assert other.err == '/switch is of type std_srvs/srv/SetBool, not std_srvs/srv/Trigger.\n'
    assert (empty.code, empty.out, number.code, number.out) == (1, '', 1, '')
    assert empty.err.startswith(
        "Failed to populate field: Value 'None' is expected to be a dictionary but is a NoneType\n"
    )
    assert number.err.startswith(
        "Failed to populate field: Value '5' is expected to be a dictionary but is a int\n"
    )


def test_doctor(ros2):
    checks, strict, report = ros2('doctor', 'doctor --include-warnings', 'doctor --report')
    assert 'UserWarning: Publisher without subscriber detected on /chatter.' in checks.err
    assert (checks.code, checks.out) == (0, '\nAll 4 checks passed\n\n')
    assert strict.code == 1 and 'topic' in strict.lines[-1]
    assert 'topic               : /chatter' in report.lines
    assert 'middleware name    : rmw_fastrtps_cpp' in report.lines
