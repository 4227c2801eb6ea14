"""Reasons for refusing input, as data: for lessons that explain them in their own words."""

from __future__ import annotations

import enum

from labkit.errors import LabError

__all__ = ['Refusal', 'Refused']


class Refusal(enum.Enum):
    """The mistake behind a refusal. The value describes it for a debugger and for tests.

    Checks use this and never parse the message, whose wording may change.
    """

    # Command line.
    QUOTE_NOT_CLOSED = 'a quotation mark has no second one'
    TERMINAL_SIGN = 'a sign that only a terminal understands, such as |'
    UNKNOWN_COMMAND = 'there is no such command'
    UNKNOWN_VERB = 'the command has no such verb'
    UNKNOWN_OPTION = 'the verb has no such option'
    QUOTES_MISSING = 'YAML without quotation marks around it fell into several words'
    TOO_MANY_WORDS = 'there are words left over'
    BAD_ARGUMENT = 'a word is missing, or an option has a value that it can not have'
    # Names and types.
    REPEATED_SLASH = 'a name has two slashes in a row'
    BAD_NAME = 'no topic or service can have such a name'
    UNKNOWN_TYPE = 'there is no type of that name'
    OTHER_TYPE = 'the topic or service is used with another type'
    # The values of a message.
    NOT_YAML = 'the values can not be read as YAML'
    SPACE_AFTER_COLON = 'the space after a colon is missing'
    NO_FIELDS = 'the values are not fields and what they hold'
    NO_SUCH_FIELD = 'the message has no such field'
    FIELDS_WANTED = 'a field that is a message itself got a single value or a list'
    LIST_FOR_NUMBER = 'a field that holds one number got a list'
    LIST_WANTED = 'a field that holds a list got something else, or a list of another length'
    NOT_A_WHOLE_NUMBER = 'a field that holds a whole number got something else'
    OUT_OF_RANGE = 'a number that the type of the field can not hold'
    NOT_A_NUMBER = 'a field that holds a number got something else'
    NOT_TRUE_OR_FALSE = 'a field that holds true or false got something else'
    NOT_A_TEXT = 'a field that holds a text got something else, or a text that is too long'
    # Everything else: a node that does not exist, a parameter that can't be set, ...
    OTHER = 'something else'


class Refused(LabError):
    """An error in the input, with its reason as data.

    Args:
        message: As for `LabError`.
        todo: As for `LabError`.
        reason: The mistake behind it.
    """

    def __init__(self, message: str, *, todo: str = '', reason: Refusal = Refusal.OTHER) -> None:
        super().__init__(message, todo=todo)
        self.reason = reason
