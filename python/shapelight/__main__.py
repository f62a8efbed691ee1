"""The shapelight command, with the formats of the extras that are installed."""

from __future__ import annotations

import signal
import sys
from typing import NoReturn

INTERRUPTED = 130
TERMINATED = 143


class _Terminated(BaseException):
    """SIGTERM, on its way through the C++ code that cleans up."""


def _on_terminate(signum: int, frame: object) -> NoReturn:
    raise _Terminated


def main() -> int:
    """Runs the command line that the process was started with; returns its exit code."""
    signal.signal(signal.SIGTERM, _on_terminate)
    try:
        from shapelight import _core

        return int(_core.run_command_line(["shapelight", *sys.argv[1:]]))
    except _Terminated:
        return TERMINATED
    except KeyboardInterrupt:
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
