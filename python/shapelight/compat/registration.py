"""Names of open3d.pipelines.registration. Its own objects are taken as well, wherever a class of this module is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InvalidInput
from ..geometry import Geometry, as_transform
from ..interop import GeometryLike, as_geometry
from ..stages.graph import build_graph
from ..stages.registration import RegistrationCloud, register_by_icp
from ..stages.spatial import KdTree


@dataclass(frozen=True)
class ICPConvergenceCriteria:
    """When to stop. Differs from Open3D: the iteration stops by the size of its steps (1e-6 rad, 1e-6 diagonals of the
    target), so `relative_fitness` and `relative_rmse` have no say."""

    relative_fitness: float = 1e-6
    relative_rmse: float = 1e-6
    max_iteration: int = 30


@dataclass(frozen=True)
class TransformationEstimationPointToPoint:
    """Squared distances between points."""

    with_scaling: bool = False


@dataclass(frozen=True)
class TransformationEstimationPointToPlane:
    """Squared distances from points to the target's tangent planes, without a robust kernel."""


@dataclass(frozen=True)
class TransformationEstimationForGeneralizedICP:
    """Plane to plane. `epsilon` is Open3D's default."""

    epsilon: float = 1e-3


@dataclass(frozen=True)
class RegistrationResult:
    """The pose, and how well the clouds fit in it."""

    transformation: NDArray[np.float64]
    """(4, 4) p_target = R p_source + t."""
    fitness: float = 0.0
    """[1] share of the source points with a target point within the distance."""
    inlier_rmse: float = 0.0
    """[input length unit] over those."""
    correspondence_set: NDArray[np.int32] = field(default_factory=lambda: np.zeros((0, 2), np.int32), repr=False)
    """(k, 2) indices in source and target."""

    def __repr__(self) -> str:
        return (
            f"RegistrationResult with fitness={self.fitness:.6e}, inlier_rmse={self.inlier_rmse:.6e}, "
            f"and correspondence_set size of {len(self.correspondence_set)}\nAccess transformation to get result."
        )


def evaluate_registration(
    source: GeometryLike,
    target: GeometryLike,
    max_correspondence_distance: float,
    transformation: Optional[ArrayLike] = None,
) -> RegistrationResult:
    """Fitness, RMSE and pairs in a pose: the same as Open3D's, which pairs every source point with the nearest target
    point that is closer than `max_correspondence_distance` [input length unit]."""
    pose = _pose(transformation)
    moving, i_source = _finite(as_geometry(source))
    fixed, i_target = _finite(as_geometry(target))
    moved = moving @ pose[:3, :3].T + pose[:3, 3]
    found = KdTree(fixed).nearest(moved, radius=_distance(max_correspondence_distance))
    paired = np.isfinite(found.distances)
    pairs = np.column_stack([i_source[paired], i_target[found.indices[paired]]]).astype(np.int32)
    rmse = float(np.sqrt(np.mean(found.distances[paired] ** 2))) if len(pairs) else 0.0
    return RegistrationResult(pose, len(pairs) / max(len(as_geometry(source)), 1), rmse, pairs)


def registration_icp(
    source: GeometryLike,
    target: GeometryLike,
    max_correspondence_distance: float,
    init: Optional[ArrayLike] = None,
    estimation_method: Any = TransformationEstimationPointToPoint(),
    criteria: Any = ICPConvergenceCriteria(),
) -> RegistrationResult:
    """Iterated closest points from a starting pose.

    Point to plane needs the target's normals, generalized ICP those of both; here too they must be there for the
    former and are estimated for the latter. Differs from Open3D: see ICPConvergenceCriteria; robust kernels and
    scaling are refused. `shapelight.register` needs no starting pose and says how sure it is.
    """
    metric, pose = _metric(estimation_method), _pose(init)
    moving, fixed = as_geometry(source), as_geometry(target)
    # Small numbers, relative to the middle of the target, so that large offsets cost no precision.
    at_target = _middle(fixed)
    at_source = np.asarray(np.linalg.solve(pose[:3, :3], at_target - pose[:3, 3]), np.float64)
    found = register_by_icp(
        _cloud(moving, at_source, _normals(moving, "source", metric) if metric == "gicp" else None),
        _cloud(fixed, at_target, None if metric == "point" else _normals(fixed, "target", metric)),
        _shift(-at_target) @ pose @ _shift(at_source),
        metric=metric,
        max_distance=_distance(max_correspondence_distance),
        max_iterations=int(criteria.max_iteration),
    )
    T_target_source = _shift(at_target) @ found.T_target_source @ _shift(-at_source)
    return evaluate_registration(source, target, max_correspondence_distance, T_target_source)


def registration_generalized_icp(
    source: GeometryLike,
    target: GeometryLike,
    max_correspondence_distance: float,
    init: Optional[ArrayLike] = None,
    estimation_method: Any = TransformationEstimationForGeneralizedICP(),
    criteria: Any = ICPConvergenceCriteria(),
) -> RegistrationResult:
    """registration_icp() plane to plane (Segal, Haehnel and Thrun 2009). Differs from Open3D: missing normals are
    estimated on 12 neighbours, in a graph that tells sheets apart."""
    return registration_icp(source, target, max_correspondence_distance, init, estimation_method, criteria)


METRICS = {
    "TransformationEstimationPointToPoint": "point",
    "TransformationEstimationPointToPlane": "plane",
    "TransformationEstimationForGeneralizedICP": "gicp",
}


def _metric(method: Any) -> Any:
    name = type(method).__name__
    if name not in METRICS:
        raise InvalidInput(f"estimation_method: {name}, expected one of {', '.join(METRICS)}")
    kernel = type(getattr(method, "kernel", None)).__name__
    if getattr(method, "with_scaling", False) or kernel not in ("NoneType", "L2Loss"):
        raise InvalidInput("estimation_method: scaling and robust kernels are not offered; use shapelight.register")
    return METRICS[name]


def _pose(transformation: Optional[ArrayLike]) -> NDArray[np.float64]:
    return as_transform(np.eye(4) if transformation is None else transformation)


def _distance(value: float) -> float:
    if not value > 0.0:
        raise InvalidInput(f"max_correspondence_distance: {value}, expected more than 0")
    return float(value)


def _finite(geometry: Geometry) -> Tuple[NDArray[np.float64], NDArray[np.int64]]:
    index = np.flatnonzero(np.isfinite(geometry.positions).all(axis=1))
    return geometry.positions[index], index


def _middle(geometry: Geometry) -> NDArray[np.float64]:
    points, _ = _finite(geometry)
    return np.asarray(points.mean(axis=0) if len(points) else np.zeros(3), np.float64)


def _cloud(geometry: Geometry, at: NDArray[np.float64], normals: Optional[NDArray[np.float64]]) -> RegistrationCloud:
    points, index = _finite(geometry)
    return RegistrationCloud(points - at, None if normals is None else normals[index])


def _normals(geometry: Geometry, name: str, metric: str) -> NDArray[np.float64]:
    """(n, 3) unit, zero where undefined."""
    columns = [geometry.attributes.get(axis) for axis in ("nx", "ny", "nz")]
    if all(column is not None for column in columns):
        normals = np.column_stack([np.asarray(column, np.float64) for column in columns])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals /= np.where(length > 0.0, length, 1.0)
        return normals
    if metric != "gicp":
        raise InvalidInput(f"{name}: point to plane needs normals, expected attributes nx, ny, nz")
    graph = build_graph(geometry)
    vertex = np.asarray(graph.vertex_of_point)
    normals = np.zeros((len(geometry), 3))
    known = vertex < len(graph.normal)
    normals[known] = graph.normal[vertex[known]]
    return normals


def _shift(by: NDArray[np.float64]) -> NDArray[np.float64]:
    T = np.eye(4)
    T[:3, 3] = by
    return T
