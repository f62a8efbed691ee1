"""Types of the keyword options of every function. Made by tools/python_options.py; do not edit."""

from __future__ import annotations

from typing import Literal, TypedDict


class SampleCovarianceOptions(TypedDict, total=False):
    """Options of sample_covariance()."""


class SampleByShapeOptions(TypedDict, total=False):
    """Options of sample_by_shape()."""

    local_weight: float
    """Share of points chosen for local detail (the paper's T). (0.65)"""


class SampleVoxelOptions(TypedDict, total=False):
    """Options of sample_voxel()."""

    voxel_fill_share: float
    """Share of an exact count that goes to the largest gaps. (0.15)"""


class AlignCoarselyOptions(TypedDict, total=False):
    """Options of align_coarsely()."""

    same_side: bool
    """The normals of both scans look at their sensors. (False)"""
    max_hypotheses: int
    """Distinct poses to return at most. [poses] (8)"""


class ComputeSurfaceVariationOptions(TypedDict, total=False):
    """Options of compute_surface_variation()."""

    variation_method: Literal["nearest", "diffusion"]
    """How the points around a vertex are gathered. (nearest)"""
    variation_neighbors: int
    """Neighbourhood of the surface variation. [points] (30)"""


class MeasureSurfaceDistanceOptions(TypedDict, total=False):
    """Options of measure_surface_distance()."""

    samples: int
    """Samples per surface; 0: ten per vertex of the larger, at least 100000. [points] (0)"""
    seed: int
    """Another seed gives other samples. (0)"""


class MetricsOptions(TypedDict, total=False):
    """Options of metrics()."""

    samples: int
    """Samples per surface; 0: ten per vertex of the larger, at least 100000. [points] (0)"""
    seed: int
    """Another seed gives other samples. (0)"""


class SampleNormalSpaceOptions(TypedDict, total=False):
    """Options of sample_normal_space()."""

    seed: int
    """Seed of the random numbers. (0)"""
    normal_collars: int
    """Rings that cut the sphere of normals from pole to pole. [rings of cells] (9)"""


class SamplePaperOptions(SampleByShapeOptions, total=False):
    """Options of sample_paper()."""

    voxel_size: float
    """Voxels of the paper's global sampling; 0: from area and count. [input length units] (0.0)"""


class SamplePoissonOptions(TypedDict, total=False):
    """Options of sample_poisson()."""

    seed: int
    """Seed of the random numbers. (0)"""
    poisson_passes: int
    """Tries to find the radius that gives the count. [passes] (6)"""


class SampleRandomOptions(TypedDict, total=False):
    """Options of sample_random()."""

    seed: int
    """Seed of the random numbers. (0)"""
    random_area_weighted: bool
    """Draw in proportion to the surface area of a point. (False)"""


class SampleStratifiedOptions(TypedDict, total=False):
    """Options of sample_stratified()."""

    seed: int
    """Seed of the random numbers. (0)"""
    stratified_suppression: float
    """Samples nearer than this to another are dropped. [stratum edges] (0.5)"""


class SimplifyQslimOptions(TypedDict, total=False):
    """Options of simplify_qslim()."""

    placement: Literal["input", "optimal"]
    """Where vertices may lie. (input)"""
    boundary_weight: float
    """Weight of the planes that hold borders in place. (1.0)"""


class BuildGraphOptions(TypedDict, total=False):
    """Options of build_graph()."""

    neighbors: int
    """Neighbours per point in the graph of a raw cloud. [points] (12)"""
    depth_jump: float
    """Longer edges between pixels of a range image are cut. [median pixel spacings] (6.0)"""
    flag_outliers: bool
    """Flag strays of a raw cloud, so that they are chosen last. (True)"""


class EstimateCurvaturesOptions(TypedDict, total=False):
    """Options of estimate_curvatures()."""

    curvature_method: Literal["taubin", "quadric", "normal-field"]
    """How curvature is estimated. (taubin)"""
    curvature_passes: int
    """Averages of the curvature tensor over the 1-ring. (1)"""
    curvature_neighbors: int
    """Support of the quadric and of the normal field. [points] (20)"""


class NonLocalMeansOptions(TypedDict, total=False):
    """Options of non_local_means()."""

    nlm_rings: int
    """Window in which similar patches are looked for. [rings] (3)"""
    nlm_candidates: int
    """Largest number of patches compared with each. [points] (64)"""
    nlm_bandwidth_sq: float
    """Patch distance that counts as similar; 0: automatic. [field unit squared] (0.0)"""


class OptimizePoseGraphOptions(TypedDict, total=False):
    """Options of optimize_pose_graph()."""

    min_confidence: float
    """Pairs that are less sure are not used. (0.5)"""
    max_chi_sq: float
    """Pairs and loops that disagree by more are wrong. (22.46)"""
    max_iterations: int
    """Iterations of the last fit at most. [iterations] (100)"""


class SegmentFieldOptions(TypedDict, total=False):
    """Options of segment_field()."""

    segment_scale: float
    """Preference for large segments, k of tau = k / size. (0.5)"""
    segment_min_points: int
    """Smaller segments join a neighbour. [points] (20)"""
    segment_min_share: float
    """Smaller shares of all vertices join a neighbour. (0.0005)"""


class SmoothPositionsOptions(TypedDict, total=False):
    """Options of smooth_positions()."""

    smoothing_iterations: int
    """Steps inwards and back. (15)"""
    smoothing_shrink: float
    """Share of the way to the neighbours' mean. (0.5)"""
    smoothing_inflate: float
    """The same, backwards. (-0.53)"""


class ComputeShapeIndexOptions(TypedDict, total=False):
    """Options of compute_shape_index()."""

    shape_index: Literal["regularised", "literal"]
    """Regularised, or the paper's literal equation 2. (regularised)"""
    curvedness_factor: float
    """Share of the median curvedness in the regularisation. (3.0)"""
    noise_factor: float
    """Share of sigma / h^2 in the regularisation. (1.5)"""
    flatness: float
    """Share of 1 / h in the regularisation. (0.02)"""


class DecomposeRetinexOptions(TypedDict, total=False):
    """Options of decompose_retinex()."""

    retinex_sigma: float
    """Spatial width of the illumination. [mean edge lengths] (3.0)"""
    retinex_range_sigma: float
    """Difference of intensity that counts as an edge. (0.15)"""
    retinex_rings: int
    """Support of one bilateral mean. [rings] (4)"""
    retinex_neighbors: int
    """Largest number of vertices in one bilateral mean. [points] (80)"""


class RefineJointlyOptions(TypedDict, total=False):
    """Options of refine_jointly()."""

    max_distance: float
    """Points farther apart do not correspond. [target spacings] (3.0)"""
    max_slide: float
    """The same, along the surface. [target spacings] (2.0)"""
    max_iterations: int
    """Iterations at most. [iterations] (30)"""
    tolerance: float
    """Stop when no scan moves more. [target spacings] (0.01)"""


class RegisterByIcpOptions(TypedDict, total=False):
    """Options of register_by_icp()."""

    metric: Literal["point", "plane", "gicp"]
    """What a pair of points costs. (plane)"""
    max_distance: float
    """Pairs farther apart have no say; 0: a tenth of the diagonal. [input length unit] (0.0)"""
    max_iterations: int
    """Iterations at most. [iterations] (100)"""
    rotation_tolerance: float
    """Stop when a step turns less. [rad] (1e-06)"""
    translation_tolerance: float
    """Stop when a step moves less. [diagonals] (1e-06)"""


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


class SimplifySsimOptions(TypedDict, total=False):
    """Options of simplify_ssim()."""

    placement: Literal["input", "optimal"]
    """Where vertices may lie. (input)"""
    sample_weight: float
    """Factor on the cost of removing a sample. (1.5)"""
    boundary_weight: float
    """Weight of the error of borders. (1.0)"""
    normal_weight: float
    """Weight of the error of normals. (0.1)"""
    pre_collapse: float
    """Quadrics collapse to this multiple of the target; 1: all the way. (3.0)"""
    sweeps: int
    """Rounds of edge flips and vertex moves at the end. [rounds] (4)"""


class RegisterByFicpOptions(TypedDict, total=False):
    """Options of register_by_ficp()."""

    lambda_: float
    """Exponent of the inlier fraction. (0.95)"""
    start_lambda: float
    """Where annealing starts; equal to lambda: pure FICP. (3.0)"""
    min_fraction: float
    """Smallest share of the pairs to trust. (0.05)"""
    max_fraction: float
    """Largest share of the pairs to trust. (1.0)"""
    max_iterations: int
    """Iterations at most, per value of lambda. [iterations] (400)"""
    rotation_tolerance: float
    """Stop when a step turns less. [rad] (1e-06)"""
    translation_tolerance: float
    """Stop when a step moves less. [diagonals] (1e-06)"""


class RegisterBySoftIcpOptions(TypedDict, total=False):
    """Options of register_by_soft_icp()."""

    candidates: int
    """Nearest points each way that a point may be matched with. [points] (1)"""
    rate: float
    """Factor by which sigma shrinks. (0.85)"""
    kappa: float
    """A pair closer than this outweighs the slack; 0: by the candidates. [sigma] (0.0)"""
    final_sigma: float
    """Where annealing ends; 0: by the candidates. [point spacings] (0.0)"""
    balance_passes: int
    """Passes of row and column normalisation. [passes] (4)"""
    max_iterations: int
    """Iterations at the final sigma at most. [iterations] (60)"""
    tolerance: float
    """Stop when a step is smaller. [rad, diagonals] (1e-06)"""


class RegisterOptions(TypedDict, total=False):
    """Options of register()."""

    method: Literal["ficp", "ficp-pure", "softicp", "icp", "plane", "gicp"]
    """How the scans are brought together. (ficp)"""
    sampler: Literal["shape", "random", "voxel", "stratified", "farthest", "poisson", "normal", "covariance"]
    """How points are chosen; both scans are thinned. (shape)"""
    ratio: float
    """Share of each scan's points to register; 0: 2000 to 10000 points. (0.0)"""
    skip_boundary: bool
    """Choose no points on the border of a scan. (True)"""
    coarse: bool
    """Without --init look for a starting pose; else start where the files say. (True)"""
    polish: bool
    """At the end, a few steps against the full target. (True)"""
    max_distance: float
    """Pairs farther apart have no say (icp, plane, gicp); 0: a tenth of the diagonal. [input length unit] (0.0)"""
    seed: int
    """Seed of the samplers that draw at random. (0)"""


class VirtualScanOptions(TypedDict, total=False):
    """Options of virtual_scan()."""

    width: int
    """Columns of the range image. [pixels] (320)"""
    height: int
    """Rows of the range image. [pixels] (320)"""
    noise: float
    """Standard deviation of the measured range. [input length unit] (0.0)"""
    quantization: float
    """Ranges are multiples of this; 0: exact. [input length unit] (0.0)"""
    dropout: float
    """Share of pixels that measure nothing. (0.0)"""
    max_incidence: float
    """Flatter surfaces are not seen. [rad] (1.4)"""
    random_pose: bool
    """Give the scan a random frame instead of the camera's. (False)"""
    seed: int
    """Seed of noise, drop-outs and the random pose. (0)"""


class ScanPairOptions(VirtualScanOptions, total=False):
    """Options of scan_pair()."""

    overlap: float
    """Share of the source's points that the target shows as well. (0.8)"""
    azimuth: float
    """Azimuth of the target's camera. [rad] (0.0)"""
    elevation: float
    """Elevation of both cameras. [rad] (0.3)"""
    field_of_view: float
    """Across the image. [rad] (0.5)"""


class AlignOptions(RegisterOptions, total=False):
    """Options of align()."""

    min_confidence: float
    """Pairs that are less sure are not used. (0.5)"""
    sequence: bool
    """The scans come in order: try neighbours, then what turns out to overlap. (False)"""
    max_all_pairs: int
    """Up to so many scans every pair is tried. [scans] (30)"""
    min_overlap: float
    """Placed scans that share so much are registered, closing loops. (0.1)"""
    refine: bool
    """At the end, move all scans at once. (True)"""


class FieldsOptions(
    ComputeShapeIndexOptions,
    DecomposeRetinexOptions,
    BuildGraphOptions,
    EstimateCurvaturesOptions,
    NonLocalMeansOptions,
    SegmentFieldOptions,
    ComputeSurfaceVariationOptions,
    total=False,
):
    """Options of fields()."""

    adaptive: bool
    """Choose curvature method, passes and denoising by the input and its noise. (True)"""
    denoise: bool
    """Non-local means on the shape index. (True)"""
    retinex: bool
    """Split the shape index into illumination and reflectance. (True)"""
    segment: bool
    """Cut the reflectance into segments. (True)"""


class SampleOptions(FieldsOptions, SampleByShapeOptions, total=False):
    """Options of sample()."""

    method: Literal["shape", "random", "voxel", "stratified", "farthest", "poisson", "normal", "covariance"]
    """How points are chosen. (shape)"""
    skip_boundary: bool
    """Leave out points on the border of an open surface. (False)"""
    seed: int
    """Seed of the methods that draw at random. (0)"""


class SimplifyOptions(FieldsOptions, SimplifySsimOptions, total=False):
    """Options of simplify()."""

    method: Literal["ssim", "ssim-paper", "qslim"]
    """How the mesh is simplified. (ssim)"""
    local_weight: float
    """Share of the guiding samples chosen for local detail (the paper's T). (0.65)"""
    noise_threshold: float
    """More noise than this: the error is measured against a denoised surface. [mean edge lengths] (0.1)"""
    measure: bool
    """Measure and report the distance between input and result. (False)"""
