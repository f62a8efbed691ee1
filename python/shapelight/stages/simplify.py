"""The methods of `shapelight.simplify` by themselves: triangles in, triangles out, without attributes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..errors import InvalidInput
from ..geometry import as_indices, as_points
from ..interop import GeometryLike, as_geometry
from ..jobs.quantities import Count, as_count
from ..progress import Progress, as_callable
from ..results import Result

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import SimplifyQslimOptions, SimplifySsimOptions

__all__ = ["SimplifiedMesh", "simplify_qslim", "simplify_ssim", "simplify_ssim_paper"]


@dataclass(frozen=True, repr=False, eq=False)
class SimplifiedMesh(Result):
    """Fewer vertices; every one is used by a face."""

    vertices: NDArray[np.float64]
    """(k, 3) [input length unit]."""
    faces: NDArray[np.uint32]
    """(m, 3) indices of vertices."""
    source_vertex: NDArray[np.uint32]
    """(k,) the input vertex it is or, with placement "optimal", descends from."""
    oddities: Dict[str, int]
    """Odd but usable things of the input, counted."""


@described("simplify_qslim")
def simplify_qslim(
    mesh_or_vertices: GeometryLike,
    triangles: Optional[ArrayLike] = None,
    /,
    *,
    vertices: Optional[Count] = None,
    faces: Optional[Count] = None,
    features: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SimplifyQslimOptions],
) -> SimplifiedMesh:
    """Quadric edge collapse (Garland and Heckbert 1997), the baseline of the paper, section III.A.

    mesh_or_vertices  a mesh, or (n, 3) vertices
    triangles         (m, 3) vertex indices, when vertices were given
    vertices          to keep, exactly, or
    faces             to keep, within one: a collapse takes two
    features          (k, 2) edges, as vertex indices, that must survive as lines: texture seams, say

    Raises InvalidInput (an index out of range, a vertex in use that is not finite, not exactly one target),
    TargetUnreachable (with `reachable`).
    """
    mesh, size = as_geometry(mesh_or_vertices, triangles)._view(attributes=False), _target(vertices, faces)
    with as_callable(progress) as report:
        found = _core.simplify_qslim(mesh, *size, _edges(features), {**options}, threads, report)
    return SimplifiedMesh(**found)


@described("simplify_ssim")
def simplify_ssim(
    mesh_or_vertices: GeometryLike,
    triangles: Optional[ArrayLike] = None,
    /,
    *,
    vertices: Optional[Count] = None,
    faces: Optional[Count] = None,
    samples: Optional[ArrayLike] = None,
    denoised: Optional[ArrayLike] = None,
    features: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SimplifySsimOptions],
) -> SimplifiedMesh:
    """SSim (paper, section III.A) by measured error: samples of the surface judge collapses, flips and moves.

    mesh_or_vertices  a mesh, or (n, 3) vertices
    triangles         (m, 3) vertex indices, when vertices were given
    vertices          to keep, exactly, or
    faces             to keep, within one: a collapse takes two
    samples           (k,) vertices that carry the shape, such as those of `shapelight.sample`: a soft prior
    denoised          (n, 3) positions of the vertices without noise: what the error is measured against
    features          (k, 2) edges, as vertex indices, that must survive as lines

    Raises InvalidInput (an index out of range, a vertex in use that is not finite, not exactly one target),
    TargetUnreachable (with `reachable`).
    """
    mesh, size = as_geometry(mesh_or_vertices, triangles)._view(attributes=False), _target(vertices, faces)
    smooth = None if denoised is None else as_points(denoised, "denoised")
    lines, chosen = _edges(features), _samples(samples)
    with as_callable(progress) as report:
        found = _core.simplify_ssim(mesh, *size, chosen, smooth, lines, {**options}, threads, report)
    return SimplifiedMesh(**found)


def simplify_ssim_paper(
    mesh_or_vertices: GeometryLike,
    triangles: Optional[ArrayLike] = None,
    /,
    *,
    vertices: Optional[Count] = None,
    faces: Optional[Count] = None,
    samples: ArrayLike,
    features: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
) -> SimplifiedMesh:
    """SSim as the paper words it: vertices that are no samples are collapsed into neighbours, cheapest quadric first.

    Where topology keeps a vertex, the cheapest sample goes instead, so the count is exact. Parameters and errors as of
    `simplify_ssim`.
    """
    mesh, size = as_geometry(mesh_or_vertices, triangles)._view(attributes=False), _target(vertices, faces)
    with as_callable(progress) as report:
        found = _core.simplify_ssim_paper(mesh, *size, _samples(samples), _edges(features), threads, report)
    return SimplifiedMesh(**found)


def _target(vertices: Optional[Count], faces: Optional[Count]) -> Tuple[int, int]:
    return as_count("vertices", vertices) or 0, as_count("faces", faces) or 0


def _edges(features: Optional[ArrayLike]) -> NDArray[Any]:
    return as_indices([] if features is None else features, "features", (-1, 2))


def _samples(samples: Optional[ArrayLike]) -> NDArray[Any]:
    return as_indices([] if samples is None else samples, "samples", (-1,))
