"""Samplers: which vertices of a graph to keep.

Every sampler returns (k,) vertices of the graph without duplicates, `graph.global_id[vertices]` being their input
indices, and chooses among `candidates`: ascending vertices, all but the flagged strays unless given. They raise
InvalidInput for candidates that are not ascending vertices and for more points than there are candidates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..errors import InvalidInput
from ..progress import Progress, as_callable
from ._arrays import as_count, as_field, as_labels, as_optional_field
from .graph import SurfaceGraph

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import (
        SampleByShapeOptions,
        SampleCovarianceOptions,
        SampleNormalSpaceOptions,
        SamplePaperOptions,
        SamplePoissonOptions,
        SampleRandomOptions,
        SampleStratifiedOptions,
        SampleVoxelOptions,
    )

__all__ = [
    "sample_by_shape",
    "sample_covariance",
    "sample_farthest",
    "sample_normal_space",
    "sample_paper",
    "sample_poisson",
    "sample_random",
    "sample_stratified",
    "sample_voxel",
    "sampling_density",
]

Target = Tuple[Optional[int], Optional[float]]


def _choose(
    sampler: Callable[..., Any],
    inputs: Tuple[Any, ...],
    target: Target,
    candidates: Optional[ArrayLike],
    options: Any,
    threads: int,
    progress: Progress,
) -> NDArray[np.uint32]:
    count, spacing = target
    if (count is None) == (spacing is None):
        raise InvalidInput("expected exactly one of count and spacing")
    points = 0 if count is None else as_count(count, "count")
    among = None if candidates is None else as_labels(candidates, "candidates")
    with as_callable(progress) as report:
        return np.asarray(sampler(*inputs, points, spacing or 0.0, among, options, threads, report))


@described("sample_random")
def sample_random(
    graph: SurfaceGraph,
    *,
    count: int,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SampleRandomOptions],
) -> NDArray[np.uint32]:
    """Uniform sample without replacement, or in proportion to the area that a vertex stands for. A ranking: every
    prefix is a sample."""
    return _choose(_core.sample_random, (graph,), (count, None), candidates, options, threads, progress)


@described("sample_voxel")
def sample_voxel(
    graph: SurfaceGraph,
    *,
    count: Optional[int] = None,
    spacing: Optional[float] = None,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SampleVoxelOptions],
) -> NDArray[np.uint32]:
    """One point per occupied cube of a regular grid, the one nearest to the centroid of the cube's points.

    count    [points] met exactly: the edge is searched, and farthest points close the gaps; or
    spacing  [input length unit] edge of a cube
    """
    return _choose(_core.sample_voxel, (graph,), (count, spacing), candidates, options, threads, progress)


@described("sample_stratified")
def sample_stratified(
    graph: SurfaceGraph,
    *,
    count: Optional[int] = None,
    spacing: Optional[float] = None,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SampleStratifiedOptions],
) -> NDArray[np.uint32]:
    """Stratified sampling (Nehab and Shilane 2004): one random point per stratum, none too close across a border.

    count    [points] met exactly, or
    spacing  [input length unit] edge of a stratum
    """
    return _choose(_core.sample_stratified, (graph,), (count, spacing), candidates, options, threads, progress)


@described("sample_poisson")
def sample_poisson(
    graph: SurfaceGraph,
    *,
    count: Optional[int] = None,
    spacing: Optional[float] = None,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SamplePoissonOptions],
) -> NDArray[np.uint32]:
    """Poisson disk sample by dart throwing (Cook 1986): maximal, no two nearer than the radius.

    count    [points] met exactly: the radius is searched, or
    spacing  [input length unit] the radius
    """
    return _choose(_core.sample_poisson, (graph,), (count, spacing), candidates, options, threads, progress)


@described("sample_normal_space")
def sample_normal_space(
    graph: SurfaceGraph,
    *,
    count: int,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SampleNormalSpaceOptions],
) -> NDArray[np.uint32]:
    """Points drawn evenly over the directions of their normals (Rusinkiewicz and Levoy 2001). A ranking.

    Raises InvalidInput, also when no candidate has a normal.
    """
    return _choose(_core.sample_normal_space, (graph,), (count, None), candidates, options, threads, progress)


@described("sample_covariance")
def sample_covariance(
    graph: SurfaceGraph,
    *,
    count: int,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SampleCovarianceOptions],
) -> NDArray[np.uint32]:
    """Geometrically stable sampling (Gelfand et al. 2003): the points that keep point-to-plane registration from
    sliding. A ranking.

    Raises InvalidInput, also when no candidate has a normal.
    """
    return _choose(_core.sample_covariance, (graph,), (count, None), candidates, options, threads, progress)


def sample_farthest(
    graph: SurfaceGraph,
    *,
    count: Optional[int] = None,
    spacing: Optional[float] = None,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
) -> NDArray[np.uint32]:
    """Farthest point sampling (Eldar et al. 1997), exact. A ranking.

    count    [points] met exactly, or
    spacing  [input length unit] until every candidate is within it of a chosen one
    """
    return _choose(_core.sample_farthest, (graph,), (count, spacing), candidates, {}, threads, progress)


def sampling_density(
    graph: SurfaceGraph,
    curvedness: ArrayLike,
    surface_variation: ArrayLike,
    shape_index: Optional[ArrayLike] = None,
    reflectance: Optional[ArrayLike] = None,
    *,
    noisy: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> NDArray[np.float64]:
    """(n,) density of samples that the shape asks for, from (n,) fields of a surface (paper, sections II.A and II.B,
    for shape index and reflectance; the density is ours). Strays and isolated vertices get 0.

    shape_index, reflectance  None: no modulation
    noisy                     the floor of the surface variation is noise: subtract it

    Raises InvalidInput (wrong length).
    """
    fields = (
        as_field(curvedness, "curvedness"),
        as_field(surface_variation, "surface_variation"),
        as_optional_field(shape_index, "shape_index"),
        as_optional_field(reflectance, "reflectance"),
    )
    with as_callable(progress) as report:
        return np.asarray(_core.sampling_density(graph, *fields, noisy, threads, report))


@described("sample_by_shape")
def sample_by_shape(
    graph: SurfaceGraph,
    density: ArrayLike,
    *,
    count: Optional[int] = None,
    spacing: Optional[float] = None,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SampleByShapeOptions],
) -> NDArray[np.uint32]:
    """Weighted farthest point sampling: a share `local_weight` of the picks follows the density, the rest fills the
    largest gaps (paper, eq. 14). A ranking.

    density  (n,) finite, 0 or more: `sampling_density`, or whatever tells where to keep points
    count    [points] met exactly, or
    spacing  [input length unit] until every candidate is within it of a chosen one

    Raises InvalidInput (wrong length, names the vertex).
    """
    inputs = (graph, as_field(density, "density"))
    return _choose(_core.sample_by_shape, inputs, (count, spacing), candidates, options, threads, progress)


@described("sample_paper")
def sample_paper(
    graph: SurfaceGraph,
    shape_index: ArrayLike,
    segment: ArrayLike,
    *,
    count: int,
    candidates: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SamplePaperOptions],
) -> NDArray[np.uint32]:
    """The paper's sampling, literally (section II.D, eq. 13 and 14): local points by segment, then global ones by
    voxel. `sample_by_shape` is the better way.

    shape_index  (n,)
    segment      (n,) labels from 0: `SegmentationResult.label`

    Raises InvalidInput (wrong length).
    """
    inputs = (graph, as_field(shape_index, "shape_index"), as_labels(segment, "segment"))
    return _choose(_core.sample_paper, inputs, (count, None), candidates, options, threads, progress)
