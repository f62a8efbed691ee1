"""Virtual scanners: range images of a mesh, and pairs of them, whose exact poses are known."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, List, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..geometry import Geometry, as_points, as_transform
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ..results import Result

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import ScanPairOptions, VirtualScanOptions

__all__ = [
    "BoundingSphere",
    "ScanPair",
    "VirtualCamera",
    "VirtualScan",
    "bounding_sphere",
    "camera_on_sphere",
    "ring_of_cameras",
    "scan_overlap",
    "scan_pair",
    "virtual_scan",
]


@dataclass(frozen=True, repr=False, eq=False)
class BoundingSphere(Result):
    """A sphere about an object, for cameras to look at."""

    center: NDArray[np.float64]
    """(3,) [input length unit]."""
    radius: float
    """[input length unit]."""


@dataclass(frozen=True, repr=False, eq=False)
class VirtualCamera(Result):
    """A pinhole camera. In its own frame it looks along z, x points to the right and y down, as in depth images."""

    T_mesh_camera: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    """(4, 4) its place in the frame of the mesh."""
    field_of_view: float = 0.5
    """[rad] across the smaller side of the image."""


@dataclass(frozen=True, repr=False, eq=False)
class VirtualScan(Result):
    """A range image in a frame of its own, and where that frame is: the truth that registration should find."""

    geometry: Geometry
    """Points, grid and viewpoint in the scan's frame."""
    T_mesh_scan: NDArray[np.float64]
    """(4, 4) p_mesh = R p_scan + t."""


@dataclass(frozen=True, repr=False, eq=False)
class ScanPair(Result):
    """Two scans of a surface, and how they truly lie."""

    source: VirtualScan
    target: VirtualScan
    T_target_source: NDArray[np.float64]
    """(4, 4) exact."""
    overlap: float
    """[1] of the two scans without noise and drop-outs: share of the source's points that the target shows."""
    azimuth_between: float
    """[rad] of the two cameras."""


def bounding_sphere(points: GeometryLike) -> BoundingSphere:
    """About the middle of the bounding box, through the finite point farthest from it."""
    return BoundingSphere(*_core.bounding_sphere(as_geometry(points).positions))


def camera_on_sphere(
    sphere: BoundingSphere, azimuth: float, elevation: float, *, field_of_view: float = 0.5, distance: float = 0.0
) -> VirtualCamera:
    """A camera that looks at the middle of the sphere from outside; y is up.

    azimuth        [rad] about y, from z towards x
    elevation      [rad]
    field_of_view  [rad]
    distance       [sphere radii] from the middle; 0: so that the sphere just fits the image
    """
    center = _center(sphere)
    return VirtualCamera(**_core.camera_on_sphere(center, sphere.radius, azimuth, elevation, field_of_view, distance))


def ring_of_cameras(
    sphere: BoundingSphere, count: int, azimuth: float, elevation: float, *, field_of_view: float = 0.5
) -> List[VirtualCamera]:
    """`count` of these, evenly spaced in azimuth, the first at `azimuth`. [rad]"""
    cameras = _core.ring_of_cameras(_center(sphere), sphere.radius, count, azimuth, elevation, field_of_view)
    return [VirtualCamera(**camera) for camera in cameras]


@described("virtual_scan")
def virtual_scan(
    surface: GeometryLike,
    camera: VirtualCamera,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[VirtualScanOptions],
) -> VirtualScan:
    """Scans a mesh: one ray through the middle of every pixel, its first hit moved along the ray by Gaussian noise.

    surface  a mesh: a Geometry, (vertices, faces), a path, ...

    Both sides of a surface are seen. Raises InvalidInput (options, no triangles, field of view outside (0, pi)).
    """
    mesh = as_geometry(surface)._view(attributes=False)
    pose, angle = as_transform(camera.T_mesh_camera, "T_mesh_camera"), camera.field_of_view
    with as_callable(progress) as report:
        found = _core.virtual_scan(mesh, pose, angle, {**options}, threads, report)
    return _scan(found)


@described("scan_pair")
def scan_pair(
    surface: GeometryLike,
    sphere: Optional[BoundingSphere] = None,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[ScanPairOptions],
) -> ScanPair:
    """Two scans of a mesh with the overlap asked for, to within 0.01: bisection finds how far apart cameras must be.

    surface  a mesh: a Geometry, (vertices, faces), a path, ...
    sphere   what the cameras look at; else the one about the mesh

    Raises InvalidInput, TargetUnreachable (nothing like that overlap is met).
    """
    geometry = as_geometry(surface)
    mesh = geometry._view(attributes=False)
    around = bounding_sphere(geometry) if sphere is None else sphere
    with as_callable(progress) as report:
        found = _core.scan_pair(mesh, _center(around), around.radius, {**options}, threads, report)
    return ScanPair(**{**found, "source": _scan(found["source"]), "target": _scan(found["target"])})


def scan_overlap(
    source: GeometryLike,
    target: GeometryLike,
    T_target_source: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
) -> float:
    """Share of the source's points within two point spacings of a target point; 0 when either has no point."""
    moving, fixed = as_geometry(source)._view(attributes=False), as_geometry(target)._view(attributes=False)
    with as_callable(progress) as report:
        pose = as_transform(T_target_source, "T_target_source")
        return float(_core.scan_overlap(moving, fixed, pose, threads, report))


def _scan(found: Dict[str, Any]) -> VirtualScan:
    return VirtualScan(Geometry(**found["geometry"]), found["T_mesh_scan"])


def _center(sphere: BoundingSphere) -> List[float]:
    return [float(x) for x in as_points([sphere.center], "center")[0]]
