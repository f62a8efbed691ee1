"""Progress of long calls: a callable, or a bar of tqdm."""

from __future__ import annotations

import contextlib
from typing import Any, Callable, Iterator, Optional, Union

from .errors import InvalidInput

Progress = Union[None, bool, Callable[[float, str], Any], Any]
"""None; True (a tqdm bar); a callable (fraction in [0, 1], phase); a tqdm class; or a bar, which is brought to its
total."""


class _Bar:
    """Moves a bar of tqdm's kind: total, n, update(step), set_description(text)."""

    def __init__(self, bar: Any) -> None:
        self.bar = bar
        self.total = bar.total or 100
        self.start = bar.n

    def __call__(self, fraction: float, phase: str) -> None:
        if phase and hasattr(self.bar, "set_description"):
            self.bar.set_description(phase, refresh=False)
        step = self.start + fraction * (self.total - self.start) - self.bar.n
        if step > 0:
            self.bar.update(step)


@contextlib.contextmanager
def as_callable(progress: Progress) -> Iterator[Optional[Callable[[float, str], Any]]]:
    """The callable that the library calls, or None. A bar that was made here is closed at the end."""
    if progress is None or progress is False:
        yield None
        return
    if progress is True:
        from tqdm.auto import tqdm

        progress = tqdm
    if isinstance(progress, type) and hasattr(progress, "update"):
        with progress(total=100.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}") as bar:
            yield _Bar(bar)
    elif hasattr(progress, "update") and hasattr(progress, "total"):
        yield _Bar(progress)
    elif callable(progress):
        yield progress
    else:
        raise InvalidInput(f"progress: {progress!r}, expected None, True, a callable or a bar of tqdm")
