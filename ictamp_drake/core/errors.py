"""Errors that a user can mend. Everything that goes wrong inside a search is a `Failure`, not an error."""


class IctampError(Exception):
    """Base of all errors raised on purpose.

    The message is one sentence that names the file, the field, the value and the valid choices; programs print it
    and exit with code 2.
    """
