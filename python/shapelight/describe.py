"""Signatures and documentation of functions from the library's own tables of options."""

from __future__ import annotations

import difflib
import functools
import inspect
from typing import Any, Callable, Dict, List, TypeVar

from . import _core

F = TypeVar("F", bound=Callable[..., Any])


def option_table(function: str) -> List[Dict[str, Any]]:
    """Options of a function: name, type, default, choices, unit, meaning, min, max. The same as those of --help."""
    return list(_core.option_tables[function])


def described(table: str) -> Callable[[F], F]:
    """Replaces the **options of a function by keyword-only parameters: in its signature, its documentation, and in
    the TypeError that a wrong name raises."""

    def decorate(function: F) -> F:
        rows = option_table(table)
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        keywords = [inspect.Parameter(r["name"], inspect.Parameter.KEYWORD_ONLY, default=r["default"]) for r in rows]
        known = {p.name for p in own} | {r["name"] for r in rows}

        @functools.wraps(function)
        def checked(*args: Any, **kwargs: Any) -> Any:
            for name in kwargs:
                if name not in known:
                    close = difflib.get_close_matches(name, known, 1)
                    hint = f", did you mean '{close[0]}'?" if close else ""
                    raise TypeError(f"{function.__name__}() got an unexpected keyword argument '{name}'{hint}")
            try:
                return function(*args, **kwargs)
            except TypeError as error:
                if "incompatible function arguments" not in str(error):
                    raise
                given = [*(type(a).__name__ for a in args), *(f"{k}: {type(v).__name__}" for k, v in kwargs.items())]
                raise TypeError(
                    f"{function.__name__}({', '.join(given)}): a type that it does not take, see help()"
                ) from None

        checked.__signature__ = signature.replace(parameters=own + keywords)  # type: ignore[attr-defined]
        checked.__doc__ = inspect.cleandoc(function.__doc__ or "") + "\n\nOptions\n" + _options_text(rows)
        return checked  # type: ignore[return-value]

    return decorate


def _options_text(rows: List[Dict[str, Any]]) -> str:
    width = max((len(r["name"]) for r in rows), default=0)
    lines = []
    for r in rows:
        unit = f" [{r['unit']}]" if r["unit"] not in ("", "1") else ""
        choices = f": {', '.join(r['choices'])}" if r["choices"] else ""
        lines.append(f"    {r['name']:<{width}}  {r['meaning']}{unit}{choices} ({r['default']})")
    return "\n".join(lines)
