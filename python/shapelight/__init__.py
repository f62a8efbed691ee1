"""Keeps the points that carry a shape: sampling, simplification and registration of meshes and scans.

    import shapelight as sl
    kept = sl.sample(points, ratio=0.1).indices
"""

from ._core import __version__
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
from .files import formats, iter_chunks, read, read_transform, register_format, write, write_transform
from .formats import register_extras
from .geometry import Geometry, concatenate
from .interop import as_geometry
from .jobs import fields, sample
from .results import FieldsResult, SampleResult

__all__ = [
    "BudgetExceeded",
    "Error",
    "FieldsResult",
    "FormatError",
    "Geometry",
    "InvalidInput",
    "PostconditionFailed",
    "ReadError",
    "SampleResult",
    "TargetUnreachable",
    "WriteError",
    "__version__",
    "as_geometry",
    "concatenate",
    "fields",
    "formats",
    "iter_chunks",
    "read",
    "read_transform",
    "register_format",
    "sample",
    "write",
    "write_transform",
]

register_extras()
