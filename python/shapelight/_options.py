"""Types of the keyword options of every function. Made by tools/python_options.py; do not edit."""

from __future__ import annotations

from typing import Literal, TypedDict


class FieldsOptions(TypedDict, total=False):
    """Options of fields()."""

    adaptive: bool
    """Choose curvature method, passes and denoising by the input and its noise. (True)"""
    denoise: bool
    """Non-local means on the shape index. (True)"""
    retinex: bool
    """Split the shape index into illumination and reflectance. (True)"""
    segment: bool
    """Cut the reflectance into segments. (True)"""
    neighbors: int
    """Neighbours per point in the graph of a raw cloud. [points] (12)"""
    depth_jump: float
    """Longer edges between pixels of a range image are cut. [median pixel spacings] (6.0)"""
    flag_outliers: bool
    """Flag strays of a raw cloud, so that they are chosen last. (True)"""
    curvature_method: Literal["taubin", "quadric", "normal-field"]
    """How curvature is estimated. (taubin)"""
    curvature_passes: int
    """Averages of the curvature tensor over the 1-ring. (1)"""
    curvature_neighbors: int
    """Support of the quadric and of the normal field. [points] (20)"""
    shape_index: Literal["regularised", "literal"]
    """Regularised, or the paper's literal equation 2. (regularised)"""
    curvedness_factor: float
    """Share of the median curvedness in the regularisation. (3.0)"""
    noise_factor: float
    """Share of sigma / h^2 in the regularisation. (1.5)"""
    flatness: float
    """Share of 1 / h in the regularisation. (0.02)"""
    variation_method: Literal["nearest", "diffusion"]
    """How the points around a vertex are gathered. (nearest)"""
    variation_neighbors: int
    """Neighbourhood of the surface variation. [points] (30)"""
    nlm_rings: int
    """Window in which similar patches are looked for. [rings] (3)"""
    nlm_candidates: int
    """Largest number of patches compared with each. [points] (64)"""
    nlm_bandwidth_sq: float
    """Patch distance that counts as similar; 0: automatic. [field unit squared] (0.0)"""
    retinex_sigma: float
    """Spatial width of the illumination. [mean edge lengths] (3.0)"""
    retinex_range_sigma: float
    """Difference of intensity that counts as an edge. (0.15)"""
    retinex_rings: int
    """Support of one bilateral mean. [rings] (4)"""
    retinex_neighbors: int
    """Largest number of vertices in one bilateral mean. [points] (80)"""
    segment_scale: float
    """Preference for large segments, k of tau = k / size. (0.5)"""
    segment_min_points: int
    """Smaller segments join a neighbour. [points] (20)"""
    segment_min_share: float
    """Smaller shares of all vertices join a neighbour. (0.0005)"""


class RenderOptions(TypedDict, total=False):
    """Options of render()."""

    width: int
    """Width of the picture. [pixels] (1200)"""
    height: int
    """Height of the picture. [pixels] (900)"""
    supersample: int
    """Smoothness of edges. [samples per pixel and axis] (2)"""
    field_of_view: float
    """Strength of the perspective; 0.1 is orthographic. [deg] (20.0)"""
    occlusion: float
    """Darkness of corners and crevices. (1.0)"""


class SampleOptions(TypedDict, total=False):
    """Options of sample()."""

    method: Literal["shape", "random", "voxel", "stratified", "farthest", "poisson", "normal", "covariance"]
    """How points are chosen. (shape)"""
    local_weight: float
    """Share of points chosen for local detail (the paper's T). (0.65)"""
    skip_boundary: bool
    """Leave out points on the border of an open surface. (False)"""
    seed: int
    """Seed of the methods that draw at random. (0)"""
    adaptive: bool
    """Choose curvature method, passes and denoising by the input and its noise. (True)"""
    denoise: bool
    """Non-local means on the shape index. (True)"""
    retinex: bool
    """Split the shape index into illumination and reflectance. (True)"""
    segment: bool
    """Cut the reflectance into segments. (True)"""
    neighbors: int
    """Neighbours per point in the graph of a raw cloud. [points] (12)"""
    depth_jump: float
    """Longer edges between pixels of a range image are cut. [median pixel spacings] (6.0)"""
    flag_outliers: bool
    """Flag strays of a raw cloud, so that they are chosen last. (True)"""
    curvature_method: Literal["taubin", "quadric", "normal-field"]
    """How curvature is estimated. (taubin)"""
    curvature_passes: int
    """Averages of the curvature tensor over the 1-ring. (1)"""
    curvature_neighbors: int
    """Support of the quadric and of the normal field. [points] (20)"""
    shape_index: Literal["regularised", "literal"]
    """Regularised, or the paper's literal equation 2. (regularised)"""
    curvedness_factor: float
    """Share of the median curvedness in the regularisation. (3.0)"""
    noise_factor: float
    """Share of sigma / h^2 in the regularisation. (1.5)"""
    flatness: float
    """Share of 1 / h in the regularisation. (0.02)"""
    variation_method: Literal["nearest", "diffusion"]
    """How the points around a vertex are gathered. (nearest)"""
    variation_neighbors: int
    """Neighbourhood of the surface variation. [points] (30)"""
    nlm_rings: int
    """Window in which similar patches are looked for. [rings] (3)"""
    nlm_candidates: int
    """Largest number of patches compared with each. [points] (64)"""
    nlm_bandwidth_sq: float
    """Patch distance that counts as similar; 0: automatic. [field unit squared] (0.0)"""
    retinex_sigma: float
    """Spatial width of the illumination. [mean edge lengths] (3.0)"""
    retinex_range_sigma: float
    """Difference of intensity that counts as an edge. (0.15)"""
    retinex_rings: int
    """Support of one bilateral mean. [rings] (4)"""
    retinex_neighbors: int
    """Largest number of vertices in one bilateral mean. [points] (80)"""
    segment_scale: float
    """Preference for large segments, k of tau = k / size. (0.5)"""
    segment_min_points: int
    """Smaller segments join a neighbour. [points] (20)"""
    segment_min_share: float
    """Smaller shares of all vertices join a neighbour. (0.0005)"""
