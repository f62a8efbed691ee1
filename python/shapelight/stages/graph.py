"""The neighbourhood that every stage works on, from a mesh, a range image or a cloud."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from .._core import RingCollector, SurfaceGraph
from ..describe import described
from ..geometry import Geometry, as_indices, as_points
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import BuildGraphOptions

__all__ = [
    "RingCollector",
    "SurfaceGraph",
    "build_graph",
    "graph_from_mesh",
    "graph_from_points",
    "graph_from_range_image",
    "graph_of_places",
    "range_image_triangles",
    "validate",
]


def _grid_geometry(positions: ArrayLike, grid: ArrayLike, viewpoint: Optional[ArrayLike]) -> _core.GeometryView:
    pixels = as_indices(grid, "grid", (-1, -1))
    geometry = Geometry(as_points(positions, "positions"), grid=pixels, viewpoint=_as_viewpoint(viewpoint))
    return geometry._view(attributes=False)


def _as_viewpoint(viewpoint: Optional[ArrayLike]) -> Optional[NDArray[np.float64]]:
    return None if viewpoint is None else as_points(np.atleast_2d(viewpoint), "viewpoint")[0]


@described("build_graph")
def build_graph(
    points_or_mesh: GeometryLike,
    faces: Optional[ArrayLike] = None,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[BuildGraphOptions],
) -> SurfaceGraph:
    """The graph by the builder that fits: of a mesh's triangles, a range image's pixels or a cloud's nearest points.

    points_or_mesh  (n, 3) points, or whatever `as_geometry` takes; C-contiguous float64 is not copied
    faces           (m, 3) vertex indices, when the points are a mesh's

    Raises InvalidInput (option out of range, a triangle names a vertex that is not there).
    """
    view = as_geometry(points_or_mesh, faces)._view(attributes=False)
    with as_callable(progress) as report:
        return _core.build_graph(view, {**options}, threads, report)


def graph_from_mesh(
    positions: ArrayLike, triangles: ArrayLike, *, threads: int = 0, progress: Progress = None
) -> SurfaceGraph:
    """Edges and areas of a triangle mesh: (n, 3) positions and (m, 3) vertex indices. Duplicate positions become one
    vertex; triangles without area are left out and counted; vertices without a triangle stay, isolated.

    Raises InvalidInput when a triangle names a vertex that is not there.
    """
    geometry = Geometry(as_points(positions, "positions"), as_indices(triangles, "triangles", (-1, 3)))
    view = geometry._view(attributes=False)
    with as_callable(progress) as report:
        return _core.graph_from_mesh(view, {}, threads, report)


@described("build_graph")
def graph_from_range_image(
    positions: ArrayLike,
    grid: ArrayLike,
    viewpoint: Optional[ArrayLike] = None,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[BuildGraphOptions],
) -> SurfaceGraph:
    """The pixel grid cut into triangles, without those that bridge a depth jump (`depth_jump`).

    positions  (n, 3)
    grid       (height, width) the point of each pixel, 0xFFFFFFFF where nothing was seen
    viewpoint  (3,) where the sensor stood: normals look towards it; else away from the centre of the points

    Raises InvalidInput (option out of range, a pixel names a point that is not there).
    """
    view = _grid_geometry(positions, grid, viewpoint)
    with as_callable(progress) as report:
        return _core.graph_from_range_image(view, {**options}, threads, report)


@described("build_graph")
def graph_from_points(
    positions: ArrayLike,
    viewpoint: Optional[ArrayLike] = None,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[BuildGraphOptions],
) -> SurfaceGraph:
    """Symmetric k-nearest-neighbour graph of (n, 3) points, with normals by principal components, oriented along a
    minimum spanning tree (Hoppe et al. 1992), towards the (3,) viewpoint or outwards, and with strays flagged.

    Raises InvalidInput (option out of range).
    """
    geometry = Geometry(as_points(positions, "positions"), viewpoint=_as_viewpoint(viewpoint))
    view = geometry._view(attributes=False)
    with as_callable(progress) as report:
        return _core.graph_from_points(view, {**options}, threads, report)


def graph_of_places(positions: ArrayLike, *, threads: int = 0, progress: Progress = None) -> SurfaceGraph:
    """Vertices without edges, normals or areas, for samplers that look at (n, 3) positions only."""
    view = Geometry(as_points(positions, "positions"))._view(attributes=False)
    with as_callable(progress) as report:
        return _core.graph_of_places(view, {}, threads, report)


def range_image_triangles(
    positions: ArrayLike, grid: ArrayLike, viewpoint: Optional[ArrayLike] = None, *, depth_jump: float = 6.0
) -> NDArray[np.uint32]:
    """(m, 3) triangles of a range image: two per square of four pixels, none across depth jumps.

    depth_jump  [median pixel spacings] longer edges are cut; with a viewpoint, spacing grows with the distance from it
    """
    return np.asarray(_core.range_image_triangles(_grid_geometry(positions, grid, viewpoint), depth_jump))


def validate(graph: SurfaceGraph) -> None:
    """Checks every invariant of a graph. Raises RuntimeError that names the first broken one."""
    _core.validate(graph)
