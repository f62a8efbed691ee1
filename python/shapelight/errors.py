"""What the library raises. Messages say where, what, and what was expected.

Every class has `code`, the exit code of the command line for the same cause, and derives from the built-in exception
that Python programmers catch for it.
"""

import re
from typing import Any


class Error(RuntimeError):
    """Base of everything the library raises."""

    code: int = 1


class InvalidInput(Error, ValueError):
    """An argument or option that the caller could have avoided."""

    code = 2


class ReadError(Error, OSError):
    """The input is missing or cannot be read."""

    code = 3


class FormatError(Error, ValueError):
    """The input's contents are malformed or unsupported; the message names the place."""

    code = 4


class TargetUnreachable(Error):
    """What was asked for cannot be reached; `reachable` is the most that can, in the unit of the target."""

    code = 5
    reachable: int = 0


class PostconditionFailed(Error):
    """A result does not hold what is promised of it, so it is withheld; `result` has it where there is one."""

    code = 6
    result: Any = None


class BudgetExceeded(Error, MemoryError):
    """The memory budget would be exceeded."""

    code = 7


class WriteError(Error, OSError):
    """The output cannot be written; nothing half-written is left."""

    code = 8


class Cancelled(Error):
    """A reader or writer was asked to stop."""

    code = 130


_FLAG = re.compile(r"(?<![^ (])--(no-)?([a-z][a-z_-]*)(?=[ :;,)]|$)")


def in_keywords(message: str) -> str:
    """A message of the library with keyword arguments in place of the command's flags."""

    def keyword(flag: "re.Match[str]") -> str:
        name = flag[2].replace("-", "_")
        if name == "force":
            return "overwrite=True"
        return f"{name}=False" if flag[1] else f"{name}_" if name == "lambda" else name

    return _FLAG.sub(keyword, message)
