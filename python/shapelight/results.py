"""What the jobs return: named fields, and `output`, the result in the type that came in."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Dict

import numpy as np
from numpy.typing import NDArray

from .geometry import Geometry
from .interop import GeometryLike, like


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        if value.size <= 3 or value.shape == (4, 4):
            return np.array2string(value, precision=6, separator=", ", prefix=" " * 4)
        return f"{value.dtype} {value.shape}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        shown = {k: v for k, v in value.items() if not (isinstance(v, int) and v == 0)}
        return "{" + ", ".join(f"{k}: {_short(v)}" for k, v in shown.items()) + "}"
    return repr(value)


class Result:
    """Base of results: a repr of one line per field, arrays by type and shape."""

    def __repr__(self) -> str:
        shown = [f for f in dataclasses.fields(self) if f.repr]  # type: ignore[arg-type]
        lines = [f"  {f.name} = {_short(getattr(self, f.name))}" for f in shown]
        return f"{type(self).__name__}(\n" + "\n".join(lines) + "\n)"


@dataclass(frozen=True, repr=False)
class SampleResult(Result):
    """Points that carry the shape."""

    indices: NDArray[np.uint32]
    """(k,) of the input, unique, in the order of selection; of method "shape" a ranking: every prefix is a sample."""
    usable: int
    """Finite points of the input."""
    candidates: int
    """Of those, distinct, not flagged as strays, and not skipped."""
    last_resort: int
    """Chosen although flagged or duplicate, since the count asked for it."""
    noise: float
    """[input length unit] standard deviation along the normal; method "shape"."""
    denoised: bool
    """Non-local means ran."""
    diagnostics: Dict[str, int]
    """Oddities of the input, counted."""
    source: GeometryLike = field(repr=False)
    geometry: Geometry = field(repr=False)
    """The input."""

    @property
    def points(self) -> NDArray[np.float64]:
        """(k, 3) in the order of `indices`."""
        return self.geometry.positions[self.indices]

    @cached_property
    def output(self) -> Any:
        """The points kept, in the order of the input, with their attributes: in the type that came in."""
        return like(self.source, self.geometry.select(np.sort(self.indices)))


@dataclass(frozen=True, repr=False)
class FieldsResult(Result):
    """What the surface says, per point. NaN (segment: -1) where a point is not finite."""

    shape_index: NDArray[np.float32]
    """(n,) in [-1, 1]: convex positive."""
    curvedness: NDArray[np.float32]
    """(n,) [1 / input length unit]."""
    illumination: NDArray[np.float32]
    """(n,) in [0, 1]: the smooth part of the shape index; empty without retinex."""
    reflectance: NDArray[np.float32]
    """(n,) in [-log 2, log 2]: the detail; empty without retinex."""
    segment: NDArray[np.int32]
    """(n,) labels from 0; empty without segment."""
    importance: NDArray[np.float32]
    """(n,) density of samples that the shape asks for."""
    noise: float
    """[input length unit] standard deviation along the normal."""
    mean_edge_length: float
    """[input length unit]."""
    denoised: bool
    curvature_method: str
    num_segments: int
    diagnostics: Dict[str, int]
    source: GeometryLike = field(repr=False)
    geometry: Geometry = field(repr=False)
    """The input with the fields among its attributes."""

    @cached_property
    def output(self) -> Any:
        """The input with the fields as attributes, in the type that came in where that can hold them, else a
        Geometry."""
        converted = like(self.source, self.geometry)
        return self.geometry if isinstance(converted, np.ndarray) else converted
