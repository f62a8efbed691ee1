"""Many scans: poses from registrations of pairs, and all scans moved at once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..errors import InvalidInput
from ..geometry import as_transform
from ..progress import Progress, as_callable
from ..results import Result
from .registration import PreparedScan, RegistrationCloud

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import OptimizePoseGraphOptions, RefineJointlyOptions

__all__ = [
    "EdgeDisagreement",
    "JointRefinementResult",
    "PairFit",
    "PoseGraphEdge",
    "PoseGraphEdgeResult",
    "PoseGraphResult",
    "ScanView",
    "measure_disagreement",
    "measure_fit",
    "optimize_pose_graph",
    "refine_jointly",
]


@dataclass(frozen=True, repr=False, eq=False)
class PoseGraphEdge(Result):
    """What one pairwise registration says about two scans."""

    target: int
    source: int
    T_target_source: NDArray[np.float64]
    """(4, 4)."""
    covariance: NDArray[np.float64] = field(default_factory=lambda: np.eye(6))
    """(6, 6) of (rotation [rad], translation [length]) about the target's origin."""
    confidence: float = 1.0
    """[1] probability that it is right, before any loop was looked at."""


@dataclass(frozen=True, repr=False)
class EdgeDisagreement(Result):
    """How poses differ from what was measured."""

    rotation: float
    """[rad]."""
    translation: float
    """[input length unit]."""
    chi_sq: float
    """[1] in standard deviations, squared; 6 are expected."""


@dataclass(frozen=True, repr=False)
class PoseGraphEdgeResult(Result):
    """What became of an edge."""

    use: str
    """"used", "low confidence", "loops disagree" or "poses disagree"."""
    confidence: float
    """[1] after the loops were looked at."""
    loops_agree: int
    """Loops of two or three edges through it that close, and ..."""
    loops_disagree: int
    """... that do not."""
    disagreement: EdgeDisagreement
    """Of the final poses; NaN between scans of different groups."""


@dataclass(frozen=True, repr=False, eq=False)
class PoseGraphResult(Result):
    """Poses of all scans."""

    T_world_scan: NDArray[np.float64]
    """(n, 4, 4); the world of a group is the frame of its first scan."""
    group: List[int]
    """Per scan; group 0 is the largest."""
    num_groups: int
    edges: List[PoseGraphEdgeResult] = field(repr=False)
    chi_sq_before: float
    """[1] sum over the used edges, with the poses of the spanning tree."""
    chi_sq_after: float
    converged: bool


@described("optimize_pose_graph")
def optimize_pose_graph(
    num_scans: int,
    edges: Sequence[PoseGraphEdge],
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[OptimizePoseGraphOptions],
) -> PoseGraphResult:
    """Poses of scans from registrations of pairs, some of which may be wrong.

    Loops are checked, their belief propagated to the edges, and the poses fitted by graduated non-convexity (Yang et
    al. 2020). Raises InvalidInput that names the edge.
    """
    given = [_edge(edge) for edge in edges]
    with as_callable(progress) as report:
        found = _core.optimize_pose_graph(num_scans, given, {**options}, threads, report)
    found["T_world_scan"] = _stack(found["T_world_scan"])
    found["edges"] = [
        PoseGraphEdgeResult(**{**edge, "disagreement": EdgeDisagreement(**edge["disagreement"])})
        for edge in found["edges"]
    ]
    return PoseGraphResult(**found)


def measure_disagreement(edge: PoseGraphEdge, T_world_scan: ArrayLike) -> EdgeDisagreement:
    """How far poses, (n, 4, 4), are from what an edge says. Raises InvalidInput."""
    return EdgeDisagreement(**_core.measure_disagreement(_edge(edge), _poses(T_world_scan)))


class ScanView(NamedTuple):
    """One scan: the samples are moved, the full scan, which has normals, is the surface that others are held against.

    A PreparedScan serves as well; mind its origin.
    """

    full: RegistrationCloud
    samples: RegistrationCloud


ScanLike = Union[ScanView, PreparedScan]


@dataclass(frozen=True, repr=False)
class PairFit(Result):
    """How two surfaces lie on each other, both ways: the samples of each against the full other one."""

    overlap: float
    """[1] share of the samples with a counterpart, of the scan that has the larger share."""
    matches: int
    """[samples] of both, that have one."""
    rms: float
    """[input length unit] point to plane, over the counterparts; 0 without any."""


@described("refine_jointly")
def measure_fit(
    target: ScanLike, source: ScanLike, T_target_source: ArrayLike, **options: Unpack[RefineJointlyOptions]
) -> PairFit:
    """How two surfaces lie on each other, both ways. Raises InvalidInput (a scan without normals)."""
    pose = as_transform(T_target_source, "T_target_source")
    return PairFit(**_core.measure_fit(_clouds(target), _clouds(source), pose, {**options}))


@dataclass(frozen=True, repr=False, eq=False)
class JointRefinementResult(Result):
    """Poses of all scans after they moved at once."""

    T_world_scan: NDArray[np.float64]
    """(n, 4, 4)."""
    iterations: int
    converged: bool


@described("refine_jointly")
def refine_jointly(
    scans: Sequence[ScanLike],
    pairs: Sequence[Tuple[int, int]],
    T_world_scan: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RefineJointlyOptions],
) -> JointRefinementResult:
    """Moves all scans at once so that, over all pairs and both ways, samples lie on the other scan's surface.

    scans         see `ScanView`
    pairs         of two different scans each, that overlap
    T_world_scan  (n, 4, 4) near the optimum; the first scan of each connected set stays

    Point to plane, reweighted by Geman and McClure. Raises InvalidInput.
    """
    views, couples = [_clouds(scan) for scan in scans], [(int(a), int(b)) for a, b in pairs]
    poses = _poses(T_world_scan)
    with as_callable(progress) as report:
        found = _core.refine_jointly(views, couples, poses, {**options}, threads, report)
    return JointRefinementResult(**{**found, "T_world_scan": _stack(found["T_world_scan"])})


def _edge(edge: PoseGraphEdge) -> Dict[str, Any]:
    covariance = np.ascontiguousarray(edge.covariance, dtype=np.float64)
    if covariance.shape != (6, 6):
        raise InvalidInput(f"covariance: shape {covariance.shape}, expected (6, 6)")
    pose = as_transform(edge.T_target_source, "T_target_source")
    return {
        "target": edge.target,
        "source": edge.source,
        "T_target_source": pose,
        "covariance": covariance,
        "confidence": float(edge.confidence),
    }


def _poses(T_world_scan: Any) -> List[NDArray[np.float64]]:
    return [as_transform(pose, f"T_world_scan[{i}]") for i, pose in enumerate(T_world_scan)]


def _stack(poses: List[NDArray[np.float64]]) -> NDArray[np.float64]:
    return np.stack(poses) if poses else np.zeros((0, 4, 4))


def _clouds(scan: ScanLike) -> Tuple[Any, Any]:
    return scan.full._cloud, scan.samples._cloud
