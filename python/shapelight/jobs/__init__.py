"""The jobs: one function each, the same names and options as the shapelight command."""

from .sampling import fields, sample
from .scans import align, register
from .surfaces import metrics, simplify

__all__ = ["align", "fields", "metrics", "register", "sample", "simplify"]
