"""Scenes: geometries side by side or on top of each other, with fields as colours and samples as dots.

A notebook shows a scene by itself. With the extra "notebook" it can be turned (see `viewer`), without it is a picture.
"""

from __future__ import annotations

import base64
import html
import importlib.util
import os
import tempfile
from dataclasses import dataclass, replace
from functools import singledispatch
from pathlib import Path
from typing import Any, Callable, List, Optional, Sequence, Tuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from .arguments import as_text, as_whole
from .errors import InvalidInput, WriteError
from .geometry import Geometry, as_indices
from .interop import as_geometry
from .pictures import Picture, distinct_color, image_grid, render, write_png
from .results import AlignResult, FieldsResult, RegisterResult, Result, SampleResult, SimplifyResult
from .thinning import thin

T = TypeVar("T")
MOST_POINTS = 300_000  # of a scene in a browser; a notebook grows by less than 10 MB
OVERLAID = ((0.16, 0.42, 0.75), (0.92, 0.50, 0.13))  # target and source: apart in hue and in lightness


@dataclass(frozen=True, repr=False, eq=False)
class Panel:
    """What is seen in one part of a scene."""

    geometry: Geometry
    color: str = "none"
    """A field as `render` takes it."""
    dots: Optional[NDArray[np.float64]] = None
    """(k, 3)."""
    title: str = ""


@dataclass(frozen=True, repr=False, eq=False)
class Scene:
    """What `show` returns: shows itself in a notebook, and can be saved."""

    panels: List[Panel]
    view: str
    height: int
    interactive: bool

    def shown(self) -> Scene:
        """The scene without points that nobody would see, which its captions tell."""
        most = MOST_POINTS // len(self.panels)
        return replace(self, panels=[_thinned(panel, most) for panel in self.panels])

    def picture(self, *, width: int = 1000, height: Optional[int] = None) -> Picture:
        """(height, width, 3) uint8, drawn by `render`. [pixels]"""
        share = width // len(self.panels)
        images = [
            render(p.geometry, color=p.color, dots=p.dots, titles=[p.title], view=self.view, width=share,
                   height=height or self.height)
            for p in self.panels
        ]  # fmt: skip
        return image_grid(images, columns=len(images))

    def save(self, path: Any, *, overwrite: bool = False) -> None:
        """One file that needs no network: ".html" as a notebook shows it, ".png" a picture of twice the size.

        Raises InvalidInput (another extension), WriteError (exists and `overwrite` is off, no space, ...).
        """
        target = Path(path)
        if target.suffix.lower() == ".png":
            write_png(target, self.picture(width=2000, height=2 * self.height), overwrite=overwrite)
        elif target.suffix.lower() in (".html", ".htm"):
            title = html.escape(self.panels[0].title or "shapelight")
            head = f'<!doctype html><meta charset="utf-8"><title>{title}</title>'
            _write_text(target, f'{head}<body style="margin:1em">{self._repr_html_()}</body>\n', overwrite)
        else:
            raise InvalidInput(f"{target}: expected .html or .png")

    def _repr_html_(self) -> str:
        shown = self.shown()
        if self.interactive:
            from .viewer import interactive_html

            return interactive_html(shown.panels, self.view, self.height)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "scene.png"
            write_png(file, shown.picture(width=2000, height=2 * self.height))
            data = base64.b64encode(file.read_bytes()).decode()
        style = "width:100%;max-width:1000px"
        return f'<img style="{style}" alt="{html.escape(repr(self))}" src="data:image/png;base64,{data}">'

    def __repr__(self) -> str:
        return f"Scene({'; '.join(p.title or repr(p.geometry) for p in self.panels)})"


def show(
    *items: Any,
    color: Any = None,
    dots: Any = None,
    titles: Optional[Sequence[str]] = None,
    overlay: bool = False,
    view: str = "auto",
    height: int = 480,
    interactive: Optional[bool] = None,
) -> Scene:
    """A scene of geometries and results, side by side. As the last line of a notebook's cell it shows itself.

    items        whatever `as_geometry` takes; results of sample, fields, simplify, register and align
    color        field to colour by: an attribute, "rgb", "normal", "x", "y", "z" or "none"; an array of one value or
                 one red, green, blue per point; or a list of such, one for each panel
    dots         points to draw on top: a SampleResult, (k,) indices, or what `as_geometry` takes; or a list, one for
                 each panel
    titles       captions, one for each panel
    overlay      all items on top of each other in one panel, each in a colour of its own
    view         "auto", "front", "back", "left", "right", "top", "bottom", "iso", or "x,y,z" of the eye
    height       [pixels]
    interactive  True: can be turned, needs the extra "notebook"; False: a picture; None: what is installed

    Raises InvalidInput.
    """
    if interactive is None:
        interactive = importlib.util.find_spec("k3d") is not None
    panels = [panel for item in items for panel in panels_of(item)]
    if not panels:
        raise InvalidInput("show: nothing to show, expected a geometry or a result")
    if overlay:
        panels = [_overlaid([p.geometry for p in panels], [p.title for p in panels])]
    if color is not None:
        panels = list({id(p.geometry): p for p in panels}.values())
        panels = _for_each(panels, _several(color, (str,)), _colored, "color")
    if dots is not None:
        panels = _for_each(panels, _several(dots, (SampleResult, int, np.integer)), _dotted, "dots")
    if titles is not None:
        panels = _for_each(panels, _several(titles, (str,)), _titled, "titles")
    for panel in panels:
        if not np.isfinite(panel.geometry.positions).all(axis=1).any():
            raise InvalidInput(f"show: {panel.geometry!r}, expected at least one finite point")
    return Scene(panels, as_text(view, "view"), as_whole(height, "height", 1), interactive)


@singledispatch
def panels_of(item: Any) -> List[Panel]:
    """How an item is best seen."""
    geometry = as_geometry(item)
    colored = "rgb" if {"red", "green", "blue"} <= set(geometry.attributes) else "none"
    return [Panel(geometry, colored, title=_counts(geometry))]


@panels_of.register
def _(result: Result) -> List[Panel]:
    return []  # numbers only


@panels_of.register
def _(result: SampleResult) -> List[Panel]:
    title = f"{len(result.indices):,} of {len(result.geometry):,} points"
    return [Panel(result.geometry, dots=result.points, title=title)]


@panels_of.register
def _(result: FieldsResult) -> List[Panel]:
    names = ["shape_index"] + (["reflectance"] if len(result.reflectance) else [])
    return [Panel(result.geometry, name) for name in names]


@panels_of.register
def _(result: SimplifyResult) -> List[Panel]:
    return [Panel(g, title=_counts(g)) for g in (result.original, result.geometry)]


@panels_of.register
def _(result: RegisterResult) -> List[Panel]:
    moved = result.geometry.transformed(result.T_target_source)
    return [_overlaid([result.target, moved], ["target", f"source, confidence {result.confidence:.2f}"])]


@panels_of.register
def _(result: AlignResult) -> List[Panel]:
    if result.merged is None:
        return []
    colors = distinct_color(result.merged.attributes["scan"])
    return [_colored(Panel(result.merged, title=f"{result.num_placed} of {len(result.scans)} scans"), colors)]


def html_of(item: Any) -> Optional[str]:
    """What a notebook shows of a geometry or a result; None: its repr."""
    try:
        return f"{show(item)._repr_html_()}<pre>{html.escape(repr(item))}</pre>"
    except InvalidInput:  # nothing to draw
        return None


def _counts(geometry: Geometry) -> str:
    faces = f", {len(geometry.triangles):,} triangles" if len(geometry.triangles) else ""
    return f"{len(geometry):,} points{faces}"


def _several(things: Any, single: Tuple[type, ...]) -> List[Any]:
    """A list or tuple as a list, unless its elements say that it is one thing."""
    if not isinstance(things, (list, tuple)):
        return [things]
    return list(things) if not things or single == (str,) or not isinstance(things[0], (int, np.integer)) else [things]


def _for_each(panels: List[Panel], values: List[T], change: Callable[[Panel, T], Panel], name: str) -> List[Panel]:
    """One value for all panels, one panel in all values, or one for each."""
    if len(panels) == 1:
        panels = panels * len(values)
    elif len(values) == 1:
        values = values * len(panels)
    if len(values) != len(panels):
        raise InvalidInput(f"{name}: {len(values)}, expected one, or one for each of {len(panels)} panels")
    return [change(panel, value) for panel, value in zip(panels, values)]


def _titled(panel: Panel, title: Any) -> Panel:
    return replace(panel, title=as_text(title, "titles"))


def _colored(panel: Panel, color: Any) -> Panel:
    if isinstance(color, str):
        return replace(panel, color=color)
    values = np.asarray(color)
    n = len(panel.geometry)
    if values.shape == (n,):
        columns = {"color": values}
    elif values.shape == (n, 3):
        columns = dict(zip(("red", "green", "blue"), np.ascontiguousarray(values.T)))
    else:
        raise InvalidInput(f"color: shape {values.shape}, expected a field's name, ({n},) or ({n}, 3)")
    geometry = replace(panel.geometry, attributes={**panel.geometry.attributes, **columns})
    return replace(panel, geometry=geometry, color="color" if values.ndim == 1 else "rgb")


def _dotted(panel: Panel, dots: Any) -> Panel:
    if isinstance(dots, SampleResult):
        return replace(panel, dots=dots.points)
    if np.ndim(dots) != 1:
        return replace(panel, dots=as_geometry(dots).positions)
    indices = as_indices(dots, "dots", (-1,))
    if len(indices) and indices.max() >= len(panel.geometry):
        raise InvalidInput(f"dots: index {indices.max()} >= {len(panel.geometry)} points")
    return replace(panel, dots=panel.geometry.positions[indices])


def _thinned(panel: Panel, most: int) -> Panel:
    fewer = thin(panel.geometry, most)
    if np.isfinite(panel.geometry.positions).all(axis=1).sum() == len(fewer):
        return replace(panel, geometry=fewer)
    note = f"shown: {len(fewer):,} of {len(panel.geometry):,}"
    return replace(panel, geometry=fewer, title=f"{panel.title}; {note}" if panel.title else note)


def _overlaid(geometries: List[Geometry], titles: List[str]) -> Panel:
    """One geometry of all; as points unless all are meshes."""
    n = len(geometries)
    colors = np.array(OVERLAID) if n <= 2 else distinct_color(np.arange(n))
    first = np.cumsum([0] + [len(g) for g in geometries])
    triangles = np.zeros((0, 3), np.uint32)
    if all(len(g.triangles) for g in geometries):
        triangles = np.concatenate([g.triangles + np.uint32(i) for g, i in zip(geometries, first)])
    whole = Geometry(np.concatenate([g.positions for g in geometries]), triangles)
    names = [t or f"{i + 1}" for i, t in enumerate(titles)]
    if n == 2:
        names = [f"{name} ({tint})" for name, tint in zip(names, ("blue", "orange"))]
    each = np.repeat(colors[:n], [len(g) for g in geometries], axis=0)
    return _colored(Panel(whole, title=", ".join(names)), np.ascontiguousarray(each, dtype=np.float32))


def _write_text(target: Path, text: str, overwrite: bool) -> None:
    """Beside the target, then renamed."""
    if target.exists() and not overwrite:
        raise WriteError(f"{target}: exists; overwrite=True replaces it")
    beside = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        try:
            beside.write_text(text, encoding="utf-8")
            beside.replace(target)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise WriteError(f"{target}: {error.strerror}") from None
