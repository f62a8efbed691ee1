"""The stages that the jobs are made of, each by itself, under the names of the C++ library."""

from . import pose_graph, registration, simplify, synthetic
from .pose_graph import *
from .registration import *
from .simplify import *
from .synthetic import *

__all__ = [
    *pose_graph.__all__,
    *registration.__all__,
    *simplify.__all__,
    *synthetic.__all__,
]
