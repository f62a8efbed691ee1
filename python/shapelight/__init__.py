"""Keeps the points that carry a shape: sampling, simplification and registration of meshes and scans.

    import shapelight as sl
    kept = sl.sample(points, ratio=0.1).indices
"""

from . import stages
from ._core import version as __version__
from .errors import (
    BudgetExceeded,
    Error,
    FormatError,
    InvalidInput,
    PostconditionFailed,
    ReadError,
    TargetUnreachable,
    WriteError,
)
from .extras import register_extras
from .files import formats, iter_chunks, read, read_transform, register_format, write, write_transform
from .geometry import Geometry, concatenate
from .interop import as_geometry, to_laspy, to_open3d, to_pyvista, to_trimesh
from .jobs import align, fields, metrics, register, sample, simplify
from .pictures import render, write_png
from .results import (
    AlignedPair,
    AlignedScan,
    AlignResult,
    DistanceSummary,
    FieldsResult,
    NormalDeviation,
    RegisterResult,
    RelativeDistance,
    SampleResult,
    SamplingQuality,
    SimplifyResult,
    SurfaceDistance,
)
from .scene import Scene, show

__all__ = [
    "AlignResult",
    "AlignedPair",
    "AlignedScan",
    "BudgetExceeded",
    "DistanceSummary",
    "Error",
    "FieldsResult",
    "FormatError",
    "Geometry",
    "InvalidInput",
    "NormalDeviation",
    "PostconditionFailed",
    "ReadError",
    "RegisterResult",
    "RelativeDistance",
    "SampleResult",
    "SamplingQuality",
    "Scene",
    "SimplifyResult",
    "SurfaceDistance",
    "TargetUnreachable",
    "WriteError",
    "__version__",
    "align",
    "as_geometry",
    "concatenate",
    "fields",
    "formats",
    "iter_chunks",
    "metrics",
    "read",
    "read_transform",
    "register",
    "register_format",
    "render",
    "sample",
    "show",
    "simplify",
    "stages",
    "to_laspy",
    "to_open3d",
    "to_pyvista",
    "to_trimesh",
    "write",
    "write_png",
    "write_transform",
]

register_extras()


def __dir__() -> "list[str]":
    return __all__
