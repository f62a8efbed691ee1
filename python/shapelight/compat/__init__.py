"""Open3D's names, for scripts that change one import. The object comes first, and comes back in its own type:

    from shapelight import compat
    thin = compat.voxel_down_sample(cloud, voxel_size=0.05)

    import shapelight.compat.registration as registration      # instead of open3d.pipelines.registration
    found = registration.registration_icp(source, target, 0.05)

Parameters and defaults are Open3D's; every docstring says where the results differ. Errors are this library's.
"""

from . import registration
from .geometry import (
    compute_point_cloud_distance,
    farthest_point_down_sample,
    random_down_sample,
    simplify_quadric_decimation,
    uniform_down_sample,
    voxel_down_sample,
)
from .registration import (
    ICPConvergenceCriteria,
    RegistrationResult,
    TransformationEstimationForGeneralizedICP,
    TransformationEstimationPointToPlane,
    TransformationEstimationPointToPoint,
    evaluate_registration,
    registration_generalized_icp,
    registration_icp,
)

__all__ = [
    "ICPConvergenceCriteria",
    "RegistrationResult",
    "TransformationEstimationForGeneralizedICP",
    "TransformationEstimationPointToPlane",
    "TransformationEstimationPointToPoint",
    "compute_point_cloud_distance",
    "evaluate_registration",
    "farthest_point_down_sample",
    "random_down_sample",
    "registration",
    "registration_generalized_icp",
    "registration_icp",
    "simplify_quadric_decimation",
    "uniform_down_sample",
    "voxel_down_sample",
]
