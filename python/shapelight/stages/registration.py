"""The parts of `shapelight.register` and `shapelight.align` by themselves.

A transform is named by its frames: p_target = T_target_source p_source. All are (4, 4), rigid, in the frames of the
clouds' own coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, List, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arguments import as_floats, as_real
from ..describe import described
from ..errors import InvalidInput
from ..geometry import Geometry, as_indices, as_points, as_transform, as_vector
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ..results import PoseAssessment, RegisterResult, Result

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import (
        AlignCoarselyOptions,
        RegisterByFicpOptions,
        RegisterByIcpOptions,
        RegisterBySoftIcpOptions,
        RegisterOptions,
    )

__all__ = [
    "DescribedPoints",
    "PoseAssessment",
    "PoseHypothesis",
    "PreparedScan",
    "RegistrationCloud",
    "RegistrationResult",
    "align_coarsely",
    "assess_pose",
    "coarse_spacing",
    "describe_points",
    "prepare_scan",
    "register_by_ficp",
    "register_by_icp",
    "register_by_soft_icp",
    "register_prepared",
]


class RegistrationCloud:
    """What registration sees of one scan: points, the surface's normal at each, and a tree over them.

    Coordinates should be small (relative to the middle of the scan), so that large offsets cost no precision.
    """

    def __init__(
        self,
        positions: ArrayLike,
        normals: Optional[ArrayLike] = None,
        *,
        viewpoint: Optional[ArrayLike] = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> None:
        """positions  (n, 3) finite [input length unit]
        normals    (n, 3) unit, zero where undefined; those of the dense scan, not of its samples
        viewpoint  (3,) place of the sensor, when known

        Raises InvalidInput (a position that is not finite, another number of normals).
        """
        directions = None if normals is None else as_points(normals, "normals")
        sensor = None if viewpoint is None else as_vector(viewpoint, "viewpoint").tolist()
        with as_callable(progress) as report:
            points = as_points(positions, "positions")
            self._cloud: Any = _core.RegistrationCloud(points, directions, sensor, threads, report)

    @classmethod
    def _of(cls, cloud: Any) -> RegistrationCloud:
        wrapper = cls.__new__(cls)
        wrapper._cloud = cloud
        return wrapper

    @property
    def position(self) -> NDArray[np.float64]:
        """(n, 3) [input length unit], read-only, not copied."""
        return np.asarray(self._cloud.position)

    @property
    def normal(self) -> NDArray[np.float64]:
        """(n, 3) unit, or (0, 3), read-only, not copied."""
        return np.asarray(self._cloud.normal)

    @property
    def spacing(self) -> float:
        """[input length unit] median distance to the nearest other place; 0 below two places."""
        return float(self._cloud.spacing)

    @property
    def diagonal(self) -> float:
        """[input length unit] of the bounding box."""
        return float(self._cloud.diagonal)

    @property
    def viewpoint(self) -> Optional[NDArray[np.float64]]:
        """(3,) place of the sensor, or None."""
        place = self._cloud.viewpoint
        return None if place is None else np.asarray(place)

    def __len__(self) -> int:
        return len(self._cloud)

    def __repr__(self) -> str:
        normals = "with" if len(self.normal) else "no"
        return f"RegistrationCloud({len(self)} points, {normals} normals, spacing={self.spacing:.6g})"


def _cloud_of(cloud: Any, name: str) -> Any:
    if not isinstance(cloud, RegistrationCloud):
        raise InvalidInput(f"{name}: {type(cloud).__name__}, expected a RegistrationCloud")
    return cloud._cloud


@dataclass(frozen=True, repr=False, eq=False)
class RegistrationResult(Result):
    """How an iteration ended."""

    T_target_source: NDArray[np.float64]
    """(4, 4)."""
    converged: bool
    stop: str
    """"fixed point", "small step", "iteration limit" or "too few pairs"."""
    iterations: int
    inlier_ratio: float
    """[1] share of the source points that had a say in the last step."""
    rms: float
    """[input length unit] point to point, over those."""
    error: NDArray[np.float64]
    """(iterations,) the method's own objective, before each step."""


@described("register_by_icp")
def register_by_icp(
    source: RegistrationCloud,
    target: RegistrationCloud,
    T_target_source: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RegisterByIcpOptions],
) -> RegistrationResult:
    """Iterated closest points, from a starting pose.

    metric "point": Besl and McKay 1992; "plane": Chen and Medioni 1992, needs the target's normals; "gicp": Segal,
    Haehnel and Thrun 2009, needs those of both. Raises InvalidInput (also below 3 points).
    """
    return _iterate(_core.register_by_icp, source, target, T_target_source, {**options}, threads, progress)


@described("register_by_ficp")
def register_by_ficp(
    source: RegistrationCloud,
    target: RegistrationCloud,
    T_target_source: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RegisterByFicpOptions],
) -> RegistrationResult:
    """Fractional ICP (Phillips, Liu and Tomasi 2007; paper, section III.B): finds motion and share of inliers at once.

    Annealed from `start_lambda` to `lambda_`. Raises InvalidInput (also below 10 points).
    """
    return _iterate(_core.register_by_ficp, source, target, T_target_source, {**options}, threads, progress)


@described("register_by_soft_icp")
def register_by_soft_icp(
    source: RegistrationCloud,
    target: RegistrationCloud,
    T_target_source: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RegisterBySoftIcpOptions],
) -> RegistrationResult:
    """SoftICP: closest-point softassign with the two-way constraint, annealed (after Liu 2007; a reconstruction).

    Raises InvalidInput (also below 10 points).
    """
    return _iterate(_core.register_by_soft_icp, source, target, T_target_source, {**options}, threads, progress)


def _iterate(
    method: Any, source: RegistrationCloud, target: RegistrationCloud, start: ArrayLike, options: Any, threads: int,
    progress: Progress,
) -> RegistrationResult:
    pose, clouds = as_transform(start, "T_target_source"), (_cloud_of(source, "source"), _cloud_of(target, "target"))
    with as_callable(progress) as report:
        return RegistrationResult(**method(*clouds, pose, options, threads, report))


@dataclass(frozen=True, repr=False, eq=False)
class DescribedPoints(Result):
    """A scan at even density, every point with a description of the surface around it."""

    spacing: float
    """[input length unit] between the points, about."""
    position: NDArray[np.float64]
    """(n, 3) [input length unit]."""
    normal: NDArray[np.float64]
    """(n, 3) unit."""
    descriptor: NDArray[np.float32]
    """(n, 33); all zero for a point without neighbours."""
    keypoints: NDArray[np.uint32]
    """(k,) of the n: those worth recognising, best first."""


@dataclass(frozen=True, repr=False, eq=False)
class PoseHypothesis(Result):
    """A guess of where the source lies."""

    T_target_source: NDArray[np.float64]
    """(4, 4)."""
    support: float
    """[matches] that agree with it."""


def coarse_spacing(cloud: RegistrationCloud) -> float:
    """The spacing at which a scan should be described: about 4000 points are left; 0 below two places.

    Scans that are to be aligned with each other share one: the largest of theirs.
    """
    return float(_core.coarse_spacing(_cloud_of(cloud, "cloud")))


def describe_points(
    cloud: RegistrationCloud,
    keypoints: ArrayLike,
    spacing: float,
    *,
    threads: int = 0,
    progress: Progress = None,
) -> DescribedPoints:
    """Thins a scan, and describes every point by its fast point feature histogram (Rusu, Blodow and Beetz 2009).

    cloud      with normals
    keypoints  (k,) indices of the cloud, best first: points on detail, off the border
    spacing    [input length unit] see `coarse_spacing`

    Raises InvalidInput (no normals, spacing not positive, keypoint out of range).
    """
    chosen = as_indices(keypoints, "keypoints", (-1,))
    with as_callable(progress) as report:
        inputs = _cloud_of(cloud, "cloud"), chosen, as_real(spacing, "spacing")
        return DescribedPoints(**_core.describe_points(*inputs, threads, report))


@described("align_coarsely")
def align_coarsely(
    source: DescribedPoints,
    target: DescribedPoints,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[AlignCoarselyOptions],
) -> List[PoseHypothesis]:
    """Poses that bring two described scans onto each other, without a starting guess; most support first.

    Matches of keypoints vote by second-order spatial compatibility (Chen et al. 2022). A pose is good to about one
    spacing and a degree or two: the start of a registration. Empty when nothing agrees. Raises InvalidInput.
    """
    moving, fixed = _described(source, "source"), _described(target, "target")
    with as_callable(progress) as report:
        found = _core.align_coarsely(moving, fixed, {**options}, threads, report)
    return [PoseHypothesis(*hypothesis) for hypothesis in found]


def _described(points: DescribedPoints, name: str) -> Any:
    descriptor = np.ascontiguousarray(points.descriptor, dtype=np.float32)
    if descriptor.ndim != 2 or descriptor.shape[1] != 33:
        raise InvalidInput(f"{name}.descriptor: shape {descriptor.shape}, expected (n, 33)")
    return {
        "spacing": float(points.spacing),
        "position": as_points(points.position, f"{name}.position"),
        "normal": as_points(points.normal, f"{name}.normal"),
        "descriptor": descriptor,
        "keypoints": as_indices(points.keypoints, f"{name}.keypoints", (-1,)),
    }


def assess_pose(
    source: RegistrationCloud,
    target: RegistrationCloud,
    T_target_source: ArrayLike,
    *,
    rivals: ArrayLike = (),
    threads: int = 0,
    progress: Progress = None,
) -> PoseAssessment:
    """Assesses a pose on the full scans: how far they overlap, how well they fit, whether the fit determines the pose.

    source, target  with normals, 3 points or more
    rivals          (k,) [1] how well other poses fit that were tried, as shares of how well this one does

    Raises InvalidInput.
    """
    pose, others = as_transform(T_target_source, "T_target_source"), np.atleast_1d(as_floats(rivals, "rivals"))
    if others.ndim != 1:
        raise InvalidInput(f"rivals: shape {others.shape}, expected (k,)")
    clouds = _cloud_of(source, "source"), _cloud_of(target, "target")
    with as_callable(progress) as report:
        found = _core.assess_pose(*clouds, pose, others, threads, report)
    return PoseAssessment(**found)


@dataclass(frozen=True, repr=False, eq=False)
class PreparedScan(Result):
    """A scan made ready to be registered with others. Coordinates of its clouds are relative to `origin`."""

    origin: NDArray[np.float64]
    """(3,) input frame."""
    full: RegistrationCloud
    """The distinct finite points that are no strays, with normals."""
    samples: RegistrationCloud
    """Those that carry its shape."""
    keypoints: NDArray[np.uint32]
    """(k,) of `full`, best first: where descriptors are taken."""
    source: GeometryLike = field(repr=False)
    geometry: Geometry = field(repr=False)
    _scan: Any = field(repr=False)


@described("register")
def prepare_scan(
    scan: GeometryLike,
    *,
    name: str = "scan",
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RegisterOptions],
) -> PreparedScan:
    """Thins a scan for `register_prepared`, so that many pairs share the work.

    name  what messages call it

    Raises FormatError (too few points to register), InvalidInput.
    """
    geometry = as_geometry(scan)
    with as_callable(progress) as report:
        ready = _core.prepare_scan(geometry._view(attributes=False), name, {**options}, threads, report)
    full, samples = RegistrationCloud._of(ready.full), RegistrationCloud._of(ready.samples)
    origin, keypoints = np.asarray(ready.origin), np.asarray(ready.keypoints)
    return PreparedScan(origin, full, samples, keypoints, scan, geometry, ready)


def _scan_of(scan: Any, name: str) -> Any:
    if not isinstance(scan, PreparedScan):
        raise InvalidInput(f"{name}: {type(scan).__name__}, expected what prepare_scan returns")
    return scan._scan


@described("register")
def register_prepared(
    source: PreparedScan,
    target: PreparedScan,
    *,
    init: Optional[ArrayLike] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RegisterOptions],
) -> RegisterResult:
    """`shapelight.register` of prepared scans: the same result. Nothing is withheld: look at `confidence`.

    init  (4, 4) rigid, source into target, input frames, to start from; else a starting pose is looked for
    """
    start = None if init is None else as_transform(init, "init")
    with as_callable(progress) as report:
        scans = _scan_of(source, "source"), _scan_of(target, "target")
        found = _core.register_prepared(*scans, start, {**options}, threads, report)
    return RegisterResult(**found, source=source.source, geometry=source.geometry, target=target.geometry)
