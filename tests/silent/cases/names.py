"""Names, see `labkit.silent.name_faults`."""

CASES = {
    'names.namespace': (
        "deaf('listener', '/chatter2'); loud('talker', 'chatter2', namespace='robot1')",
        "deaf('listener', '/robot2/chatter2'); loud('talker', 'chatter2', namespace='robot1')",
    ),
    'names.absolute': (
        "deaf('driver', 'odom', namespace='robot1'); loud('base', '/odom', namespace='robot1')",
        "deaf('driver', 'odom', namespace='robot1'); loud('base', 'odom', namespace='robot1')",
    ),
    'names.private': (
        "deaf('listener', 'status'); loud('motor', '~/status')",
        "deaf('listener', '/motor/status'); loud('motor', '~/status')",
    ),
    'names.case': (
        "deaf('listener', '/Chatter'); loud('talker', '/chatter')",
        "deaf('listener', '/Chatter'); loud('talker', '/chatter'); loud('other', '/Chatter')",
    ),
    'names.underscore': (
        "deaf('robot', '/cmdvel', Twist); loud('driver', '/cmd_vel', Twist)",
        "deaf('robot', '/cmdvel', Twist); loud('driver', '/cmd_vel')",
    ),
    'names.plural': (
        "deaf('adder', '/numbers'); loud('source', '/number')",
        "n = deaf('adder', '/numbers'); n.create_publisher(String, '/number', 10)",
    ),
    'names.spelling': (
        "deaf('listener', '/chater'); loud('talker', '/chatter')",
        "deaf('listener', '/motor_1'); loud('talker', '/motor_2')",
    ),
    'names.service': (
        "node('server').create_service(SetBool, 'lamp_on', heard)\n"
        "node('client').create_client(SetBool, 'lamps_on')",
        "node('server').create_service(SetBool, 'lamp_on', heard)\n"
        "node('client').create_client(Trigger, 'lamps_on')",
    ),
    'names.action': (
        "ActionServer(node('server'), Fibonacci, 'fibonacci', heard)\n"
        "ActionClient(node('client'), Fibonacci, 'fibonaci')",
        "ActionServer(node('server'), Fibonacci, 'fibonacci', heard)\n"
        "ActionClient(node('client'), Fibonacci, 'fibonacci')",
    ),
    'names.topic-of-service': (
        "node('server').create_service(Trigger, 'reset', heard); deaf('listener', 'reset')",
        "node('server').create_service(Trigger, 'reset', heard)\n"
        "deaf('listener', 'reset'); loud('talker', 'reset')",
    ),
    'names.service-of-topic': (
        "loud('talker', 'battery'); node('client').create_client(Trigger, 'battery')",
        "loud('talker', 'battery'); node('client').create_client(Trigger, 'battery')\n"
        "node('server').create_service(Trigger, 'battery', heard)",
    ),
    'names.double': (
        "node('twin'); other_process('twin'); all_named(3)",
        "node('twin'); other_process('twin_2'); all_named(3)",
    ),
}
