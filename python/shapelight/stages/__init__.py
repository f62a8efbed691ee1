"""The stages that the jobs are made of, each by itself, under the names of the C++ library.

    from shapelight import stages
    graph = stages.build_graph(mesh)
    curvatures = stages.estimate_curvatures(graph)
    shape_index = stages.compute_shape_index(graph, curvatures, sigma=stages.estimate_noise(graph))

Stages take and return one value per vertex of a SurfaceGraph. `values[graph.vertex_of_point]` spreads them over the
points of the input, where all are finite; `graph.global_id[vertices]` are the input indices of vertices.
"""

from . import denoise, features, graph, metrics, pipeline, retinex, sample, segment, spatial
from .denoise import *
from .features import *
from .graph import *
from .metrics import *
from .pipeline import *
from .retinex import *
from .sample import *
from .segment import *
from .spatial import *

__all__ = [
    *denoise.__all__,
    *features.__all__,
    *graph.__all__,
    *metrics.__all__,
    *pipeline.__all__,
    *retinex.__all__,
    *sample.__all__,
    *segment.__all__,
    *spatial.__all__,
]
