"""What the jobs return: named fields, and `output`, the result in the type that came in."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Dict, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from .geometry import Geometry
from .interop import GeometryLike, like, like_with


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        if value.size <= 3 or value.shape == (4, 4):
            return np.array2string(value, precision=6, separator=", ", prefix=" " * 16, max_line_width=120)
        return f"{value.dtype} {value.shape}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        shown = {k: v for k, v in value.items() if not (isinstance(v, int) and v == 0)}
        return "{" + ", ".join(f"{k}: {_short(v)}" for k, v in shown.items()) + "}"
    return repr(value)


class Result:
    """Base of results: a repr of all fields, arrays by type and shape; on one line where that is short.

    Those that hold arrays are equal only to themselves, as geometries are.
    """

    def __repr__(self) -> str:
        names = [f.name for f in dataclasses.fields(self) if f.repr]  # type: ignore[arg-type]
        names.sort(key=lambda name: not name.startswith("T_"))  # the pose first, wherever a base class puts it
        shown = [f"{name}={_short(getattr(self, name))}" for name in names]
        line = ", ".join(shown)
        if len(line) <= 80 and "\n" not in line:
            return f"{type(self).__name__}({line})"
        return f"{type(self).__name__}(\n  " + ",\n".join(shown).replace("\n", "\n  ") + "\n)"

    def _repr_html_(self) -> Optional[str]:
        from .scene import html_of

        return html_of(self)


@dataclass(frozen=True, repr=False, eq=False)
class SampleResult(Result):
    """Points that carry the shape."""

    indices: NDArray[np.uint32]
    """(k,) of the input, unique, in the order of selection; of method "shape" a ranking: every prefix is a sample."""
    usable: int
    """Finite points of the input."""
    candidates: int
    """Of those, distinct, not flagged as strays, and not skipped."""
    is_partial: bool
    """Fewer points than were asked for: all there are."""
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


@dataclass(frozen=True, repr=False, eq=False)
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
        names = ("shape_index", "curvedness", "importance")
        return like_with(self.source, self.geometry, names)


@dataclass(frozen=True, repr=False)
class DistanceSummary(Result):
    """Distances from one surface to another, [input length unit]."""

    mean: float
    """Over the area."""
    rms: float
    """Over the area."""
    max: float
    """Over the samples and all vertices: the one-sided Hausdorff distance from below."""


@dataclass(frozen=True, repr=False)
class NormalDeviation(Result):
    """Angles between the face normals at a point and at its closest point, [deg]."""

    rms: float
    p95: float
    """95th percentile."""


@dataclass(frozen=True, repr=False)
class RelativeDistance(Result):
    """Distances by the diagonal of the reference's bounding box, [1]."""

    forward: DistanceSummary
    backward: DistanceSummary
    symmetric: DistanceSummary


@dataclass(frozen=True, repr=False, eq=False)
class SurfaceDistance(Result):
    """How far two surfaces are apart, both ways, as Metro measures it."""

    forward: DistanceSummary
    """From the reference to the test mesh; its rms is the RMSE."""
    backward: DistanceSummary
    """From the test mesh to the reference."""
    symmetric: DistanceSummary
    """Mean of the means, root of the mean square, larger maximum."""
    vertex_rms: float
    """[input length unit] over the vertices of the reference, to the test mesh."""
    diagonal: float
    """[input length unit] of the reference's bounding box; see `relative`."""
    normal_deviation_deg: NormalDeviation
    """Of both directions together."""
    samples: int
    """[points] per surface."""
    distances: Optional[NDArray[np.float64]] = None
    """(n,) from every vertex of the test mesh to the reference, when asked for."""

    @property
    def relative(self) -> RelativeDistance:
        """The same by the diagonal of the reference."""
        sides = (self.forward, self.backward, self.symmetric)
        return RelativeDistance(*(DistanceSummary(*(x / self.diagonal for x in (d.mean, d.rms, d.max))) for d in sides))

    @property
    def rmse(self) -> float:
        """Of the reference's points to the test surface: the paper's eq. 15."""
        return self.forward.rms


@dataclass(frozen=True, repr=False, eq=False)
class SamplingQuality(Result):
    """How well points stand for the points of a reference. Lengths in input units; features are the tenth of the
    reference with the largest surface variation over 30 neighbours."""

    coverage_max: float
    """Largest distance from a reference point to its nearest sample."""
    coverage_mean: float
    feature_coverage_max: float
    feature_coverage_mean: float
    feature_share: float
    """[1] of the samples that lie on features."""
    spacing_mean: float
    """Mean distance from a sample to the nearest other one."""
    spacing_min: float
    spacing_cv: float
    """[1] standard deviation of those distances by their mean."""
    distances: Optional[NDArray[np.float64]] = None
    """(n,) from every test point to the surface of the reference, when asked for."""


def surface_distance(found: Dict[str, Any], **more: Any) -> SurfaceDistance:
    """From what the extension module returns."""
    sides = {side: DistanceSummary(**found[side]) for side in ("forward", "backward", "symmetric")}
    deviation = NormalDeviation(**found["normal_deviation_deg"])
    return SurfaceDistance(**{**found, **sides, "normal_deviation_deg": deviation, **more})


@dataclass(frozen=True, repr=False, eq=False)
class SimplifyResult(Result):
    """Fewer vertices, the same shape."""

    vertices: NDArray[np.float64]
    """(k, 3) [input length unit]."""
    faces: NDArray[np.uint32]
    """(m, 3) indices of vertices."""
    source_vertex: NDArray[np.uint32]
    """(k,) the input vertex it is or, with placement "optimal", descends from."""
    sampled: bool
    """The input was a cloud: its points were sampled."""
    is_partial: bool
    """The target could not be reached: as far as it goes."""
    vertices_in: int
    faces_in: int
    noise: float
    """[input length unit] standard deviation along the normal, of the methods that look at it."""
    denoised: bool
    """The error was measured against a denoised surface."""
    oddities: Dict[str, int]
    """Odd but usable things of the input, counted."""
    measured: Optional[SurfaceDistance]
    """Input to result; with max_error or measure."""
    warnings: List[str]
    source: GeometryLike = field(repr=False)
    original: Geometry = field(repr=False)
    """The input."""
    geometry: Geometry = field(repr=False)
    """The simplified mesh with the input's attributes."""

    @property
    def output(self) -> Any:
        """The simplified mesh in the type that came in; (vertices, faces) for arrays."""
        converted = like(self.source, self.geometry)
        return (converted, self.faces) if isinstance(converted, np.ndarray) else converted


@dataclass(frozen=True, repr=False, eq=False)
class PoseAssessment(Result):
    """What speaks for a pose and against it, measured on the full scans."""

    confidence: float
    """[1] calibrated share of right poses among poses that look like this one."""
    doubt: str
    """What speaks most against it; may be empty."""
    overlap: float
    """[1] share of a scan's points within the gate of the other; of the scan that has more."""
    mean_error: float
    """[input length unit] over reciprocal correspondences: the paper's e_mu."""
    std_error: float
    """[input length unit] the paper's e_delta."""
    reciprocal_share: float
    """[1] of the source points that have a reciprocal correspondence."""
    residual: float
    """[input length unit] point to plane over the overlap: 1.4826 times the median."""
    gate: float
    """[input length unit] how close surfaces must come to count as one."""
    contrast: float
    """[1] how much more often surfaces lie within the gate than chance would have them."""
    normal_agreement: float
    """[1] share of the pairs whose normals agree."""
    in_free_space: float
    """[1] share of the points that a sensor looked through, of those in its sight; 0: unknown."""
    conditioning: float
    """[1] smallest over largest eigenvalue of the scaled information; 0: undetermined."""
    weakest_direction: str
    """The motion that the surfaces say least about."""
    weakest_uncertainty: float
    """[input length unit] standard deviation of the points along it."""
    covariance: NDArray[np.float64] = field(repr=False)
    """(6, 6) of (turn [rad] about, slide [length] of) the target's origin."""
    rival_weight: float
    """[1] of the rivals beside this pose."""


@dataclass(frozen=True, repr=False, eq=False)
class RegisterResult(PoseAssessment):
    """The motion that brings the source onto the target, and what speaks for it."""

    T_target_source: NDArray[np.float64]
    """(4, 4) p_target = R p_source + t."""
    fit: float
    """[1] how well the samples of the scan that fits better lie on the other one."""
    rival_fit: float
    """[1] the same of the best other pose that was tried."""
    converged: bool
    stop: str
    """Why the iteration ended."""
    iterations: int
    inlier_ratio: float
    """[1] share of the source's samples that had a say in the last step."""
    rms: float
    """[input length unit] point to point, of the last iteration."""
    source_samples: int
    target_samples: int
    hypotheses: int
    """Starting poses tried; 0 when one was given."""
    warnings: List[str]
    source: GeometryLike = field(repr=False)
    geometry: Geometry = field(repr=False)
    """The source as it came."""
    target: Geometry = field(repr=False)

    @cached_property
    def output(self) -> Any:
        """The source, moved onto the target: in the type that came in."""
        return like(self.source, self.geometry.transformed(self.T_target_source))


@dataclass(frozen=True, repr=False, eq=False)
class AlignedScan(Result):
    """Where one scan of many lies."""

    T_world_scan: NDArray[np.float64]
    """(4, 4), within the scan's group only."""
    group: int
    """0 is the largest; a scan that nothing sure connects has a group of its own."""
    partners: List[int]
    """Scans that it overlaps."""
    rms: float
    """[input length unit] point to plane, over its overlaps."""


@dataclass(frozen=True, repr=False, eq=False)
class AlignedPair(Result):
    """A pair of scans that was registered."""

    target: int
    source: int
    T_target_source: NDArray[np.float64]
    use: str
    """"used", or why not."""
    confidence: float
    """[1] after the loops were looked at."""
    registration_confidence: float
    overlap: float
    closes_loop: bool
    rms_before: float
    """[input length unit] point to plane, as registered."""
    rms_after: float
    """[input length unit] with the final poses; 0 between different groups."""


@dataclass(frozen=True, repr=False, eq=False)
class AlignResult(Result):
    """Many scans in one frame."""

    scans: List[AlignedScan] = field(repr=False)
    pairs: List[AlignedPair] = field(repr=False)
    """Every pair tried."""
    num_groups: int
    num_placed: int
    """Scans in group 0."""
    chi_sq_before: float
    chi_sq_after: float
    warnings: List[str]
    sources: Tuple[GeometryLike, ...] = field(repr=False)
    merged: Optional[Geometry] = field(repr=False)
    """All points of the placed scans in one frame, with `scan`, the index of the scan; when asked for."""

    @property
    def poses(self) -> NDArray[np.float64]:
        """(n, 4, 4) T_world_scan of every scan; NaN for those that were not placed."""
        lost = np.full((4, 4), np.nan)
        return np.stack([scan.T_world_scan if scan.group == 0 else lost for scan in self.scans])

    @property
    def all_placed(self) -> bool:
        """One group holds every scan."""
        return self.num_placed == len(self.scans)
