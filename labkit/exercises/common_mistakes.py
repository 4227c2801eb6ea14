"""Mistakes that can be made in any exercise. Their words are in `common_mistakes.yaml`.

What is special to one exercise stands beside it, in its lesson.
"""

from __future__ import annotations

from labkit.exercises.words import words_of

WORDS = words_of(__file__)

# -- Nodes and the names in the graph ------------------------------------------------------------

NODE_NAME = WORDS.mistake('node/name')
NO_NODE = WORDS.mistake('node/missing')
TWO_NODES = WORDS.mistake('node/twice')
CAPITALS = WORDS.mistake('name/capitals')
NAMESPACE = WORDS.mistake('name/namespace')
UNDERSCORE = WORDS.mistake('name/underscore')
OTHER_NAME = WORDS.mistake('name/other')
STRANGE_TOPIC = WORDS.mistake('name/strange')

# -- Publishers and subscriptions ----------------------------------------------------------------

MADE_AGAIN = WORDS.mistake('publisher/made-again')
TWO_COPIES = WORDS.mistake('publisher/two-copies')
SECOND_PUBLISHER = WORDS.mistake('publisher/second')
REPLACED = WORDS.mistake('endpoint/replaced')
NOT_MADE = WORDS.mistake('endpoint/not-made')
HEARS_ITSELF = WORDS.mistake('endpoint/hears-itself')
OTHER_TYPE = WORDS.mistake('endpoint/type')

# -- Quality of service --------------------------------------------------------------------------

DEFAULT_QOS = WORDS.mistake('qos/default')
OTHER_QOS = WORDS.mistake('qos/other')
OFFER_AND_REQUEST = WORDS.mistake('qos/offer-and-request')
UNUSUAL_QOS = WORDS.mistake('qos/unusual')
GIVEN_IS_GONE = WORDS.mistake('qos/given')
NOT_KEPT = WORDS.mistake('qos/not-kept')
KEPT_FOR_A_WHILE = WORDS.mistake('qos/kept-for-a-while')
KEPT_TOO_MANY = WORDS.mistake('qos/kept-too-many')

# -- Callbacks that run --------------------------------------------------------------------------

NOTHING_RUNS = WORDS.mistake('spin/nothing-runs')
BLOCKS = WORDS.mistake('spin/blocks')
OUTLASTS = WORDS.mistake('spin/outlasts')
OVERLOADED = WORDS.mistake('spin/overloaded')
NOT_TAKEN = WORDS.mistake('spin/not-taken')
INIT_WAITS = WORDS.mistake('spin/init-waits')
NOT_SPUN = WORDS.mistake('spin/not-spun')
PROGRAM_WAITS = WORDS.mistake('spin/program-waits')
FLOOD = WORDS.mistake('spin/flood')

# -- What messages say ---------------------------------------------------------------------------

CHANGES = WORDS.mistake('values/changes')
LATER_WRONG = WORDS.mistake('values/later')
NOT_SET = WORDS.mistake('values/not-set')
EMPTY_LATER = WORDS.mistake('values/empty-later')
ONLY_SPACES = WORDS.mistake('values/only-spaces')
VALUE_TYPE = WORDS.mistake('text/type')
SPACE_AT = WORDS.mistake('text/space-at')
SPACES = WORDS.mistake('text/spaces')
LETTERS = WORDS.mistake('text/letters')
TOO_LONG = WORDS.mistake('text/too-long')
TOO_SHORT = WORDS.mistake('text/too-short')

# -- Services and actions ------------------------------------------------------------------------

SERVICE_TYPE = WORDS.mistake('service/type')
OTHER_SERVER = WORDS.mistake('service/other-node')
TWO_SERVERS = WORDS.mistake('service/two')
NOT_ANSWERED = WORDS.mistake('service/not-spun')
NO_SERVER = WORDS.mistake('service/not-made')
SERVICE_SILENT = WORDS.mistake('service/silent')
SERVER_ENDED = WORDS.mistake('service/ended')
SOME_UNANSWERED = WORDS.mistake('service/some')
ACTION_SILENT = WORDS.mistake('action/silent')

# -- Parameters ----------------------------------------------------------------------------------

PARAMETER_MISSING = WORDS.mistake('parameter/missing')
PARAMETER_NAME = WORDS.mistake('parameter/name')
PARAMETER_TYPE = WORDS.mistake('parameter/type')
NO_DESCRIPTION = WORDS.mistake('parameter/description')
NO_RANGE = WORDS.mistake('parameter/no-range')
OTHER_RANGE = WORDS.mistake('parameter/range')
NO_RESULT = WORDS.mistake('parameter/no-result')
REFUSES_ALLOWED = WORDS.mistake('parameter/refuses-allowed')
REFUSES_SET = WORDS.mistake('parameter/refuses-set')
PARAMETER_RATE = WORDS.mistake('parameter/rate')
READ_ONCE = WORDS.mistake('parameter/read-once')
NO_REASON = WORDS.mistake('parameter/no-reason')
CHANGES_ANYWAY = WORDS.mistake('parameter/changes-anyway')
USES_ANYWAY = WORDS.mistake('parameter/uses-anyway')
TAKES_SOME = WORDS.mistake('parameter/takes-some')
TAKES_TOGETHER = WORDS.mistake('parameter/takes-together')
TAKES_ALL = WORDS.mistake('parameter/takes-all')
TAKES_NAN = WORDS.mistake('parameter/takes-nan')
PARAMETERS_SILENT = WORDS.mistake('parameter/silent')

# -- Log lines -----------------------------------------------------------------------------------

NOT_LOGGED = WORDS.mistake('logs/none')
LOGS_LATE = WORDS.mistake('logs/late')
LOGS_ELSE = WORDS.mistake('logs/else')
LOGS_SOME = WORDS.mistake('logs/some')
LOGS_TWICE = WORDS.mistake('logs/twice')
LOGS_BESIDE = WORDS.mistake('logs/beside')
LOGS_UNASKED = WORDS.mistake('logs/unasked')

# -- Traces of something else --------------------------------------------------------------------

NAME_LOST = WORDS.mistake('traces/name-lost')
SOMETHING_ELSE = WORDS.mistake('traces/something-else')
SHUT_DOWN = WORDS.mistake('traces/shut-down')
KEPT_TOPIC = WORDS.mistake('traces/kept-topic')
NOTHING_MADE = WORDS.mistake('traces/nothing-made')
ONLY_A_CLASS = WORDS.mistake('traces/only-a-class')
CLASS_CHANGED = WORDS.mistake('traces/class-changed')
PROCESS_ENDED = WORDS.mistake('traces/process-ended')
OTHERS_SHARE = WORDS.mistake('traces/others-share')

# -- What comes in time --------------------------------------------------------------------------

STOPS = WORDS.mistake('rate/stops')
BURSTS = WORDS.mistake('rate/bursts')
TOO_FEW = WORDS.mistake('rate/too-few')
OTHER_RATE = WORDS.mistake('rate/other')
RIGHT_PERIOD = WORDS.mistake('rate/right-period')
RATE_FOR_PERIOD = WORDS.mistake('rate/for-period')
TWICE_AS_MANY = WORDS.mistake('rate/twice')
ANOTHER_SOURCE = WORDS.mistake('rate/another-source')
SAID_BY_TWO = WORDS.mistake('rate/two-publishers')
ONE_OF_THESE = WORDS.mistake('rate/one-of-these')
NEVER_PUBLISHED = WORDS.mistake('silent/never')
NEVER_RUN = WORDS.mistake('silent/not-run')
NO_CLOCK = WORDS.mistake('silent/no-clock')
ONLY_ANSWERS = WORDS.mistake('silent/only-answers')
NO_TIMER = WORDS.mistake('silent/no-timer')
WENT_ELSEWHERE = WORDS.mistake('silent/went-elsewhere')
NOT_PUBLISHED = WORDS.mistake('silent/not-published')
NOT_CALLED = WORDS.mistake('silent/not-called')
KEPT_ALIVE = WORDS.mistake('ends/kept-alive')
