"""What a check says of mistakes that can be made in any exercise.

What is special to one exercise stands beside it, in its lesson. Names in braces are values of the
moment.
"""

from __future__ import annotations

from labkit.exercises.mistakes import Mistake

# -- Nodes and the names in the graph ------------------------------------------------------------

NODE_NAME = Mistake(
    'node/name', '', 'The name is what Node() gets, or super().__init__() in a class: {bare!r}.'
)
NO_NODE = Mistake(
    'node/missing',
    'There is no node called {node}.',
    'The name is what Node() gets, or super().__init__() in a class: {bare!r}. Each node has to '
    'be made, and handed over with lab.spin.',
)
TWO_NODES = Mistake(
    'node/twice',
    'Two copies of the node run at once. Each does its work, so everything happens twice.',
    'End one of them: lab.remove(...), or stop the other process or notebook.',
)
CAPITALS = Mistake(
    'name/capitals',
    'Capital and small letters differ in names: {seen} and {wanted} are two names.',
)
NAMESPACE = Mistake(
    'name/namespace',
    'The last part is right, but it lies in another namespace: names must be equal from the first '
    'slash to the last letter. A "~" puts the name of the node before it.',
)
UNDERSCORE = Mistake(
    'name/underscore',
    'The names differ in an underscore; names must be equal to the last character.',
)
OTHER_NAME = Mistake(
    'name/other',
    '{seen} is not {wanted}: names must be equal to the last letter. A slip of the pen?',
)
STRANGE_TOPIC = Mistake(
    'name/strange',
    'The node works with a topic of another name, so no node that looks for {topic} finds it.',
    'Write the topic as {topic!r}.',
)

# -- Publishers and subscriptions ----------------------------------------------------------------

MADE_AGAIN = Mistake(
    'publisher/made-again',
    '{node} makes a publisher again and again: create_publisher() is called in a callback or in a '
    'loop.',
    'Make the publisher once, in __init__, keep it as self.publisher, and only publish in the '
    'callback.',
)
TWO_COPIES = Mistake(
    'publisher/two-copies',
    'Two copies of the node run at once, and their messages mix on the topic.',
    'End one of them: stop the other process, or shut the other notebook down.',
)
SECOND_PUBLISHER = Mistake(
    'publisher/second',
    'Another node publishes on the same topic. A subscriber hears both, and cannot tell them '
    'apart.',
    "End the one that does not belong here, such as lab.remove('name'); a node of another "
    'notebook ends there.',
)
NOT_MADE = Mistake(
    'endpoint/not-made',
    'create_{kind}() for this topic has not been called, or not yet.',
    'Call it in __init__ with {msg_type} and {topic!r}.',
)
HEARS_ITSELF = Mistake(
    'endpoint/hears-itself',
    'The node hears what it says itself, answers that too, and so on for ever.',
    'Publish on a topic of its own.',
)
OTHER_TYPE = Mistake(
    'endpoint/type',
    'A topic carries one type of message. Two sides with different types never hear each other, '
    'and nobody says so.',
    'Import {msg_type} from {package}.msg and use it for this topic.',
)

# -- Quality of service --------------------------------------------------------------------------

DEFAULT_QOS = Mistake(
    'qos/default',
    'A number alone as the last argument is the depth; everything else is then the default: '
    'reliable and volatile.',
    'Pass a QoSProfile with {policy}={name}Policy.{wanted}.',
)
OTHER_QOS = Mistake('qos/other', '', 'Pass a QoSProfile with {policy}={name}Policy.{wanted}.')
OFFER_AND_REQUEST = Mistake(
    'qos/offer-and-request',
    'A publisher offers, and a subscription asks. Where it asks for more than is offered, no '
    'message passes.',
    '{todo}',
)
UNUSUAL_QOS = Mistake(
    'qos/unusual',
    'No message goes from one side to the other where QoS profiles do not match, and nobody says '
    'so.',
    'Ask for less in the profile of the subscription. A number alone, the depth, asks for what is '
    'usual.',
)
GIVEN_IS_GONE = Mistake(
    'qos/given',
    'On a robot that end belongs to somebody else: you cannot change it.',
    'End it, and change your own node. If that of the lesson is gone: {start}',
)
NOT_KEPT = Mistake(
    'qos/not-kept',
    'What was published is not kept.',
    'Keep one publisher as long as the node lives: self.publisher.',
)
KEPT_FOR_A_WHILE = Mistake(
    'qos/kept-for-a-while',
    'What is older than the lifespan is thrown away. Who subscribes {seconds:g} s later hears '
    'nothing.',
    'Leave lifespan out of the profile of the publisher.',
)
KEPT_TOO_MANY = Mistake(
    'qos/kept-too-many',
    'A publisher with durability transient local keeps as many messages as its depth says. The '
    'older ones are heard first.',
    'Give the profile of the publisher depth=1.',
)

# -- Callbacks that run --------------------------------------------------------------------------

NOTHING_RUNS = Mistake(
    'spin/nothing-runs',
    'Something keeps them all from running, such as the condition of a wait that does not return.',
    'Stop what waits, and check again. If that does not help, restart the kernel.',
)
BLOCKS = Mistake(
    'spin/blocks',
    'While a callback runs, no other one can: no message is taken, no timer ticks. A callback '
    'that waits or loops holds everything up.',
    'Do one small step in the callback and return. For "again later" use a timer.',
)
OUTLASTS = Mistake(
    'spin/outlasts',
    'The callback {callback} takes {took:.3g} s or more, and its timer is due every '
    '{period:.3g} s. The next call waits until it has returned.',
    'Do less in it, and return at once: do not sleep there. Or give the timer a longer period.',
)
OVERLOADED = Mistake(
    'spin/overloaded',
    'What takes longer than the time until it is due again comes later and later.',
    'Do less each time, or do it less often.',
)
NOT_TAKEN = Mistake(
    'spin/not-taken', 'Messages come and wait in the queue. Nothing takes them out.', '{spin}'
)
NOT_SPUN = Mistake(
    'spin/not-spun',
    'A node that is made is in the graph, but it does nothing before somebody spins it.',
    '{spin}',
)
PROGRAM_WAITS = Mistake(
    'spin/program-waits',
    'Its program does something else, such as a loop that waits. So it neither takes messages nor '
    'answers questions.',
    '{spin}',
)
FLOOD = Mistake(
    'spin/flood',
    'A timer has no period, or a message sets off another one, which sets off the next one, '
    'without an end.',
    'Give the timer a period in seconds, and publish on a topic that the node does not hear '
    'itself, or do not answer what the node has said itself.',
)

# -- What messages say ---------------------------------------------------------------------------

CHANGES = Mistake(
    'values/changes',
    'The value changes from message to message. Here it is the same each time.',
    'Set the field to the same value in each call of the callback.',
)
LATER_WRONG = Mistake(
    'values/later',
    'The first messages were right, the later ones are not.',
    'Look at what changes the value after some calls of the callback.',
)
NOT_SET = Mistake(
    'values/not-set',
    'The message was published as it was made: its field {field} is an empty text at first.',
    'Set the field before you publish: msg.{field} = ...',
)
ONLY_SPACES = Mistake(
    'values/only-spaces',
    'A text of spaces says nothing.',
    'Set the field before you publish: msg.{field} = ...',
)
_COMPARE = 'Compare the value that is wanted with the one seen.'
VALUE_TYPE = Mistake('text/type', 'The value is a {kind}.', _COMPARE)
SPACE_AT = Mistake(
    'text/space-at',
    'A space {what} at the {where} of the text. A space is a character like any other.',
    _COMPARE,
)
SPACES = Mistake(
    'text/spaces',
    'The spaces are not where they should be. A space is a character like any other.',
    _COMPARE,
)
LETTERS = Mistake('text/letters', 'Capital and small letters differ.', _COMPARE)
TOO_LONG = Mistake('text/too-long', 'The text goes on after that, with {more!r}.', _COMPARE)
TOO_SHORT = Mistake('text/too-short', 'The text ends too early: {less!r} is missing.', _COMPARE)

# -- Services and actions ------------------------------------------------------------------------

SERVICE_TYPE = Mistake(
    'service/type',
    'The type says what a request and a response hold. A client of one type does not reach a '
    'server of another one.',
    'Import {name} from {package}.{kind} and pass it to {maker}.',
)
OTHER_SERVER = Mistake(
    'service/other-node',
    'Another node serves {service}.',
    'Make the server of {node} itself, in its class: self.create_service(...)',
)
TWO_SERVERS = Mistake(
    'service/two',
    'Each of them answers each request. Which response a client gets is a matter of luck.',
    'End the one that does not belong here: lab.remove(...), or stop the other process or '
    'notebook.',
)
NOT_ANSWERED = Mistake(
    'service/not-spun', 'Requests come and wait. Nobody calls the callback.', '{spin}'
)
NO_SERVER = Mistake(
    'service/not-made',
    '{maker} for it has not been called, or not yet.',
    'Call it in __init__ with {name} and {service!r}.',
)
SERVICE_SILENT = Mistake(
    'service/silent',
    'The callback of the service has not returned, or it has raised an error.',
    'Let the callback fill in the response, return it, and wait for nothing.',
)
SERVER_ENDED = Mistake(
    'service/ended',
    'The server of {service} has ended meanwhile.',
    'Look at the output of its program: a callback may have raised an error.',
)
SOME_UNANSWERED = Mistake(
    'service/some',
    'Of several requests at once, not all are answered.',
    'Let the callback fill in the response, return it, and wait for nothing.',
)
ACTION_SILENT = Mistake(
    'action/silent',
    'A callback of the action has not returned, or it has raised an error.',
    'Each callback has to return: goal_callback a GoalResponse, cancel_callback a CancelResponse, '
    'execute_callback a Result.',
)

# -- Parameters ----------------------------------------------------------------------------------

PARAMETER_MISSING = Mistake(
    'parameter/missing',
    'A node has the parameters that it declares, and no others.',
    'In __init__: self.declare_parameter({name!r}, ...)',
)
PARAMETER_NAME = Mistake(
    'parameter/name',
    '{near} is not {name}: names must be equal to the last letter.',
    'In __init__: self.declare_parameter({name!r}, ...)',
)
PARAMETER_TYPE = Mistake(
    'parameter/type',
    'The type of a parameter is that of the value it is declared with: 2 is an integer, 2.0 a '
    'double.',
    'Declare it with a value of type {kind}.',
)
NO_DESCRIPTION = Mistake(
    'parameter/description',
    'Somebody who asks for the parameter later is not told what it stands for, nor its unit.',
    "Pass ParameterDescriptor(description='...') to declare_parameter().",
)
_RANGE = (
    'Pass it in the ParameterDescriptor: floating_point_range='
    '[FloatingPointRange(from_value=..., to_value=...)]'
)
NO_RANGE = Mistake(
    'parameter/no-range',
    'A range in the descriptor is checked by ROS itself, and others can read it.',
    _RANGE,
)
OTHER_RANGE = Mistake('parameter/range', '', _RANGE)
NO_RESULT = Mistake(
    'parameter/no-result',
    'The callback that is asked before a change has not given back a SetParametersResult. Without '
    '"return" a function gives back None.',
    'End it with: return SetParametersResult(...)',
)
REFUSES_ALLOWED = Mistake(
    'parameter/refuses-allowed',
    'These values are allowed, and a node that refuses them cannot be used.',
    'Compare what your callback, or the range, allows with the task.',
)
REFUSES_SET = Mistake(
    'parameter/refuses-set',
    'These values are allowed, and a node that refuses them cannot be used.',
    'Compare what your callback, or the range, allows with the task. A callback gets all '
    'parameters that are set at once, and the node still has the old values.',
)
READ_ONCE = Mistake(
    'parameter/read-once',
    'The parameter has changed, and what the node does has not: it has read the value once, or '
    'its timer still has the old period.',
    'Change what depends on the parameter in a callback: '
    'self.add_post_set_parameters_callback(self.on_change). Or read the parameter anew each time.',
)
NO_REASON = Mistake(
    'parameter/no-reason',
    'The caller learns that the value was refused, but not why.',
    "Say it: SetParametersResult(successful=False, reason='...')",
)
_LOOK_ONLY = (
    'Let the callback that may refuse only look. What follows a change belongs into '
    'add_post_set_parameters_callback().'
)
CHANGES_ANYWAY = Mistake(
    'parameter/changes-anyway',
    'It has refused {values}, and changed all the same.',
    _LOOK_ONLY,
)
USES_ANYWAY = Mistake(
    'parameter/uses-anyway', 'The node has refused a value, and uses it all the same.', _LOOK_ONLY
)
_LIMIT = (
    'Limit it by a range in the descriptor, or in a callback that returns '
    "SetParametersResult(successful=False, reason='...'): "
    'self.add_on_set_parameters_callback(self.on_set).'
)
TAKES_SOME = Mistake(
    'parameter/takes-some', 'Some values are refused, and this one is not.', _LIMIT
)
TAKES_TOGETHER = Mistake(
    'parameter/takes-together',
    'Some values are refused, and this one is not. What is allowed depends on both parameters, '
    'and each of them may change.',
    _LIMIT,
)
TAKES_ALL = Mistake(
    'parameter/takes-all', 'Nothing looks at the value before the node uses it.', _LIMIT
)
TAKES_NAN = Mistake(
    'parameter/takes-nan',
    'A comparison with nan is always False. So "if value > limit" lets nan pass.',
    _LIMIT,
)
PARAMETERS_SILENT = Mistake(
    'parameter/silent',
    'A callback for parameters has not returned, or it has raised an error.',
    'Let it return soon. Look at the output of the node, too.',
)

# -- Log lines -----------------------------------------------------------------------------------

NOT_LOGGED = Mistake(
    'logs/none',
    'The callback does not log it. print() shows a text here; the logger also tells all other '
    'nodes of it.',
    "In the callback: self.get_logger().info(f'...{{msg.data}}')",
)
LOGS_ELSE = Mistake(
    'logs/else',
    'The callback runs, but its line does not hold what the message says.',
    "In the callback: self.get_logger().info(f'...{{msg.data}}')",
)
LOGS_SOME = Mistake(
    'logs/some',
    'Some messages are logged as they came, and this one is not.',
    "In the callback: self.get_logger().info(f'...{{msg.data}}')",
)
LOGS_TWICE = Mistake(
    'logs/twice',
    'The same message is logged more than once.',
    'Call get_logger().info(...) once in the callback.',
)
LOGS_BESIDE = Mistake(
    'logs/beside',
    'Another line is logged when a message comes, beside the one that is asked for.',
    'Call get_logger().info(...) once in the callback, and in no other place.',
)
LOGS_UNASKED = Mistake(
    'logs/unasked', 'A timer or a loop logs, too.', 'Log in the callback of the subscription only.'
)

# -- Traces of something else --------------------------------------------------------------------

NAME_LOST = Mistake(
    'traces/name-lost',
    'A node of the same name ended while this one was made, and took its name along.',
    'Run the cell of the node again.',
)
SOMETHING_ELSE = Mistake(
    'traces/something-else',
    'There is a node of yours, but nothing of it is what this task asks for: compare the names of '
    'node and topics, and the type, letter by letter.',
    'Change the cell of the node and run it again. A node that belongs elsewhere ends with '
    'lab.remove({node!r}).',
)
SHUT_DOWN = Mistake(
    'traces/shut-down',
    'rclpy.shutdown() and sys.exit() end a whole program. In a notebook they end the node that '
    'calls them.',
    'Leave it out, and run the cell of the node again. lab.remove(...) ends a node.',
)
ONLY_A_CLASS = Mistake(
    'traces/only-a-class',
    'A class is a plan. Nothing runs before a node is made of it.',
    'Make one, and hand it over: lab.spin({name}(...)), with what its __init__ takes.',
)
PROCESS_ENDED = Mistake(
    'traces/process-ended',
    'A program ends when its last line is done or when an error comes up. rclpy.spin(node) in the '
    'last line keeps it going.',
    'See what it says: print(subprocess.run([sys.executable, "-c", program], capture_output=True, '
    'text=True).stderr)',
)
OTHERS_SHARE = Mistake(
    'traces/others-share',
    'A node that listens hears all of them, and cannot tell them apart.',
    'End what does not belong here: lab.remove({other!r})',
)

# -- What comes in time --------------------------------------------------------------------------

_ONE_EACH = 'Publish once in each call of a timer with this period, and let it go on.'
_PERIOD = 'The first argument of create_timer() is the period in seconds: {period:.3g}'
_IN_CALLBACK = 'Call self.publisher.publish(msg) in the callback.'
STOPS = Mistake('rate/stops', 'They stop coming.', _ONE_EACH)
BURSTS = Mistake('rate/bursts', 'They come in bursts, or with pauses.', _ONE_EACH)
TOO_FEW = Mistake(
    'rate/too-few', 'The messages come much too slowly, or have stopped coming.', _PERIOD
)
OTHER_RATE = Mistake(
    'rate/other',
    'The rate is set by the period of the timer, or by the time the loop sleeps.',
    _PERIOD,
)
RATE_FOR_PERIOD = Mistake(
    'rate/for-period',
    'A rate in Hz and a period in seconds were mixed up: the period is 1 / rate.',
    _PERIOD,
)
TWICE_AS_MANY = Mistake(
    'rate/twice',
    'Twice as many messages come as were asked for: is publish() called twice, or is the period '
    'half as long?',
    _PERIOD,
)
SAID_BY_TWO = Mistake(
    'rate/two-publishers',
    'Each thing is said by two publishers, so it is said twice.',
    'Make one publisher, in __init__, and keep it.',
)
ONE_OF_THESE = Mistake(
    'rate/one-of-these',
    'One of these nodes does not publish at this rate: {nodes}.',
    'Compare what they do, line by line.',
)
NEVER_PUBLISHED = Mistake(
    'silent/never', 'publish() was called too early, once, or never.', 'Publish from a timer.'
)
NEVER_RUN = Mistake(
    'silent/not-run',
    'The node exists, but nothing runs its callbacks, and no loop publishes.',
    'Hand the node over: lab.spin(node)',
)
NO_CLOCK = Mistake(
    'silent/no-clock',
    'With use_sim_time a node has its time from /clock, and nobody publishes there. Its clock '
    'stands still, and so do its timers.',
    'Set use_sim_time only beside a simulator.',
)
ONLY_ANSWERS = Mistake(
    'silent/only-answers',
    'The node publishes only when it hears something on {topic}, and nothing comes there, or its '
    'callback does not publish.',
    _IN_CALLBACK,
)
NO_TIMER = Mistake(
    'silent/no-timer',
    'The node has no timer: publish() ran once at most, when the node was made, and nobody was '
    'there to hear it.',
    'Make a timer in __init__ with self.create_timer(period, self.on_timer), and publish in '
    'on_timer.',
)
NOT_PUBLISHED = Mistake(
    'silent/not-published',
    'The timer calls its callback, but publish() is not called there, or not any more.',
    _IN_CALLBACK,
)
NOT_CALLED = Mistake(
    'silent/not-called',
    'The timer has hardly called its callback, or not at all: its period is {period:.3g} s.',
    'The first argument of create_timer() is the period in seconds.',
)
KEPT_ALIVE = Mistake(
    'ends/kept-alive',
    'Something keeps the node alive: a thread or a loop that does not end with it.',
    'Let the loop end when rclpy.ok() is False or the node is destroyed.',
)
