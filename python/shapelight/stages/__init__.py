"""The stages that the jobs are made of, each by itself, under the names of the C++ library.

    from shapelight import stages
    graph = stages.build_graph(mesh)
    curvatures = stages.estimate_curvatures(graph)
    shape_index = stages.compute_shape_index(graph, curvatures, sigma=stages.estimate_noise(graph))

Stages take and return one value per vertex of a SurfaceGraph. `values[graph.vertex_of_point]` spreads them over the
points of the input, where all are finite; `graph.global_id[vertices]` are the input indices of vertices.
"""

from . import (
    denoise,
    features,
    graph,
    metrics,
    pipeline,
    pose_graph,
    registration,
    retinex,
    sample,
    segment,
    simplify,
    spatial,
    synthetic,
)
from .denoise import *
from .features import *
from .graph import *
from .metrics import *
from .pipeline import *
from .pose_graph import *
from .registration import *
from .retinex import *
from .sample import *
from .segment import *
from .simplify import *
from .spatial import *
from .synthetic import *

__all__ = [
    *denoise.__all__,
    *features.__all__,
    *graph.__all__,
    *metrics.__all__,
    *pipeline.__all__,
    *pose_graph.__all__,
    *registration.__all__,
    *retinex.__all__,
    *sample.__all__,
    *segment.__all__,
    *simplify.__all__,
    *spatial.__all__,
    *synthetic.__all__,
]
