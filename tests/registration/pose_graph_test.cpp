#include "shapelight/registration/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "shapelight/core/error.hpp"
#include "support/determinism.hpp"
#include "support/shapes.hpp"

// Poses from pairs: exact, noisy and wrong edges, rings, groups.
namespace shapelight {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSigma = 1e-3;  // of rotation [rad] and translation [1]

RigidTransform motion(const Vec3& rotation, const Vec3& translation) {
  RigidTransform T = RigidTransform::Identity();
  if (rotation.norm() > 0.0) T.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
  T.translation() = translation;
  return T;
}

Vec3 noise(std::uint64_t stream, std::uint64_t id) {
  return {testing::gaussian(5, 10 * stream, id), testing::gaussian(5, 10 * stream + 1, id),
          testing::gaussian(5, 10 * stream + 2, id)};
}

double angle_between(const RigidTransform& a, const RigidTransform& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

// Scanners around an object, each with an arbitrary roll; the first one's frame is the world.
std::vector<RigidTransform> ring(std::size_t count) {
  std::vector<RigidTransform> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    poses.push_back(motion({0, 0, angle}, Vec3::Zero()) * motion(0.4 * noise(1, i), Vec3(2, 0, 0) + 0.1 * noise(2, i)));
  }
  const RigidTransform first = poses.front();
  for (RigidTransform& pose : poses) pose = first.inverse() * pose;
  return poses;
}

PoseGraphEdge edge(const std::vector<RigidTransform>& poses, std::size_t target, std::size_t source,
                   double error_in_sigmas = 0.0) {
  PoseGraphEdge edge;
  edge.target = target;
  edge.source = source;
  const std::uint64_t id = 1000 * target + source;
  const double size = error_in_sigmas * kSigma;
  edge.T_target_source = motion(size * noise(3, id), size * noise(4, id)) * poses[target].inverse() * poses[source];
  edge.covariance = kSigma * kSigma * Matrix6::Identity();
  edge.confidence = 0.9;
  return edge;
}

PoseGraphEdge wrong_edge(std::size_t target, std::size_t source, std::uint64_t trial = 0) {
  PoseGraphEdge edge;
  edge.target = target;
  edge.source = source;
  const std::uint64_t id = 1000000 * trial + 1000 * target + source;
  edge.T_target_source = motion(noise(6, id), 2.0 * noise(7, id));
  edge.covariance = kSigma * kSigma * Matrix6::Identity();
  edge.confidence = 0.9;
  return edge;
}

// Edges from each scan to the next `reach` ones, around.
std::vector<PoseGraphEdge> ring_edges(const std::vector<RigidTransform>& poses, std::size_t reach, double error) {
  std::vector<PoseGraphEdge> edges;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t k = 1; k <= reach; ++k) edges.push_back(edge(poses, i, (i + k) % poses.size(), error));
  }
  return edges;
}

double largest_angle(const PoseGraphResult& result, const std::vector<RigidTransform>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    largest = std::max(largest, angle_between(result.T_world_scan[i], truth[i]));
  }
  return largest;
}

double largest_shift(const PoseGraphResult& result, const std::vector<RigidTransform>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    largest = std::max(largest, (result.T_world_scan[i].translation() - truth[i].translation()).norm());
  }
  return largest;
}

TEST(PoseGraph, ConsistentEdgesGiveThePosesExactly) {
  const auto truth = ring(12);
  const PoseGraphResult result = optimize_pose_graph(12, ring_edges(truth, 2, 0.0));
  EXPECT_LT(largest_angle(result, truth), 1e-12);
  EXPECT_LT(largest_shift(result, truth), 1e-12);
  EXPECT_EQ(result.num_groups, 1u);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.chi_sq_after, 1e-16);
  for (const PoseGraphEdgeResult& e : result.edges) {
    EXPECT_EQ(e.use, EdgeUse::Used);
    EXPECT_GT(e.confidence, 0.99) << "all loops close";
    EXPECT_EQ(e.loops_disagree, 0u);
  }
}

// Noise of 20 degrees, and covariances to match: the spanning tree starts far from the optimum.
TEST(PoseGraph, EndsAtAnOptimum) {
  const double sigma = 0.35;
  Vector6 shape;  // of the covariance: with a round one, errors of the Jacobian would not show
  shape << 1.0, 4.0, 0.5, 1.0, 0.3, 2.0;
  const auto truth = ring(12);
  auto edges = ring_edges(truth, 3, sigma / kSigma);
  for (PoseGraphEdge& e : edges) e.covariance = sigma * sigma * Matrix6(shape.asDiagonal());
  const PoseGraphResult result = optimize_pose_graph(12, edges);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.chi_sq_after, result.chi_sq_before);
  const auto cost = [&](const std::vector<RigidTransform>& poses) {
    double sum = 0.0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (result.edges[e].use != EdgeUse::Used) continue;
      const RigidTransform off =
          poses[edges[e].target].inverse() * poses[edges[e].source] * edges[e].T_target_source.inverse();
      const Eigen::AngleAxisd turn(off.linear());
      Vector6 error;
      error << turn.angle() * turn.axis(), off.translation();
      sum += error.cwiseAbs2().cwiseQuotient(shape).sum() / (sigma * sigma);
    }
    return sum;
  };
  const double best = cost(result.T_world_scan);
  EXPECT_NEAR(best, result.chi_sq_after, 1e-9 * best);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    for (int axis = 0; axis < 6; ++axis) {
      const auto cost_beside = [&](double by) {
        Vector6 step = Vector6::Zero();
        step[axis] = by;
        auto poses = result.T_world_scan;
        poses[i] = poses[i] * motion(step.head<3>(), step.tail<3>());
        return cost(poses);
      };
      EXPECT_LT(std::abs(cost_beside(1e-4) - cost_beside(-1e-4)) / 2e-4, 1e-4) << "the slope";
      EXPECT_GT(cost_beside(1e-4), best);
    }
  }
}

TEST(PoseGraph, ClosingTheLoopSpreadsTheError) {
  const auto truth = ring(12);
  auto chain = ring_edges(truth, 1, 1.0);
  const PoseGraphEdge closing = chain.back();
  chain.pop_back();
  const double open = largest_angle(optimize_pose_graph(12, chain), truth);
  chain.push_back(closing);
  const PoseGraphResult closed = optimize_pose_graph(12, chain);
  EXPECT_LT(largest_angle(closed, truth), open);
  EXPECT_LT(largest_angle(closed, truth), 4.0 * kSigma);
  EXPECT_LT(closed.chi_sq_after, closed.chi_sq_before);
  for (const PoseGraphEdgeResult& e : closed.edges) EXPECT_EQ(e.use, EdgeUse::Used);
}

TEST(PoseGraph, NoisyEdgesAverageOut) {
  const auto truth = ring(12);
  const PoseGraphResult few = optimize_pose_graph(12, ring_edges(truth, 1, 1.0));
  const PoseGraphResult many = optimize_pose_graph(12, ring_edges(truth, 5, 1.0));
  EXPECT_LT(largest_angle(many, truth), 2.0 * kSigma);
  EXPECT_LT(largest_angle(many, truth), largest_angle(few, truth));
  // Expected: 6 per edge, less 6 per free scan.
  EXPECT_NEAR(many.chi_sq_after, 6.0 * (60 - 11), 75.0);
}

TEST(PoseGraph, PreciseEdgesOutweighVagueOnes) {
  const std::vector<RigidTransform> truth = {RigidTransform::Identity(), motion({0, 0, 0.3}, {1, 0, 0})};
  PoseGraphEdge precise = edge(truth, 0, 1), vague = edge(truth, 1, 0);
  vague.covariance *= 100.0 * 100.0;
  vague.T_target_source = motion({0, 0, 0.05}, {0, 0.05, 0}) * vague.T_target_source;
  const PoseGraphResult result = optimize_pose_graph(2, std::vector{precise, vague});
  EXPECT_LT(largest_angle(result, truth), 2e-5);
  EXPECT_EQ(result.edges[1].use, EdgeUse::Used);
  EXPECT_NEAR(result.edges[1].disagreement.rotation, 0.05, 1e-4);
}

// Three edges in ten are wrong, and look a little surer than the right ones.
TEST(PoseGraph, SurvivesWrongEdges) {
  std::size_t num_lost = 0;
  for (std::size_t trial = 0; trial < 10; ++trial) {
    const auto truth = ring(12);
    auto edges = ring_edges(truth, 4, 1.0);
    std::vector<bool> is_wrong(edges.size());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      is_wrong[e] = random01(trial, 0, e) < 0.3;
      if (!is_wrong[e]) continue;
      edges[e] = wrong_edge(edges[e].target, edges[e].source, trial);
      edges[e].confidence = 0.91;
    }
    const PoseGraphResult result = optimize_pose_graph(12, edges);
    EXPECT_EQ(result.num_groups, 1u) << trial;
    EXPECT_LT(largest_angle(result, truth), 4.0 * kSigma) << trial;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const bool is_used = result.edges[e].use == EdgeUse::Used;
      EXPECT_FALSE(is_used && is_wrong[e]) << trial << ": edge " << e;
      num_lost += !is_used && !is_wrong[e] ? 1 : 0;
    }
  }
  EXPECT_LE(num_lost, 3u) << "right edges of 480, by noise";
}

TEST(PoseGraph, AWrongClosureWithoutTrianglesIsDropped) {
  const auto truth = ring(12);
  auto edges = ring_edges(truth, 1, 1.0);
  edges.push_back(wrong_edge(2, 8));
  edges.push_back(wrong_edge(5, 11));
  edges[12].confidence = edges[13].confidence = 0.7;
  const PoseGraphResult result = optimize_pose_graph(12, edges);
  EXPECT_LT(largest_angle(result, truth), 4.0 * kSigma);
  for (std::size_t e = 0; e < 12; ++e) EXPECT_EQ(result.edges[e].use, EdgeUse::Used);
  for (const std::size_t e : {12, 13}) {
    EXPECT_EQ(result.edges[e].use, EdgeUse::PosesDisagree);
    EXPECT_GT(result.edges[e].disagreement.rotation, 10 * kDegree);
    EXPECT_GT(result.edges[e].disagreement.chi_sq, 1000.0);
  }
}

// Two edges place scan 3, and disagree: nobody knows which is right, so neither is believed.
TEST(PoseGraph, ContradictionWithoutAWitnessPlacesNothing) {
  const auto truth = ring(4);
  std::vector<PoseGraphEdge> edges = {edge(truth, 0, 1), edge(truth, 1, 2), edge(truth, 0, 2), edge(truth, 0, 3),
                                      wrong_edge(1, 3)};
  edges[3].confidence = edges[4].confidence = 0.7;
  const PoseGraphResult result = optimize_pose_graph(4, edges);
  EXPECT_EQ(result.group, (std::vector<std::size_t>{0, 0, 0, 1}));
  EXPECT_EQ(result.edges[3].use, EdgeUse::LoopsDisagree);
  EXPECT_EQ(result.edges[4].use, EdgeUse::LoopsDisagree);
  EXPECT_TRUE(std::isnan(result.edges[3].disagreement.chi_sq));
  // Where one is far surer, it wins.
  edges[3].confidence = 0.99;
  const PoseGraphResult decided = optimize_pose_graph(4, edges);
  EXPECT_EQ(decided.num_groups, 1u);
  EXPECT_EQ(decided.edges[3].use, EdgeUse::Used);
  EXPECT_NE(decided.edges[4].use, EdgeUse::Used);
  EXPECT_LT(largest_angle(decided, truth), 1e-9);
}

TEST(PoseGraph, GroupsAreNumberedBySizeAndHaveTheirOwnWorlds) {
  const auto truth = ring(7);
  // {0}, {1, 4}, {2, 3, 5, 6}: scan 0 hangs on an edge that nobody is sure of.
  std::vector<PoseGraphEdge> edges = {edge(truth, 1, 4), edge(truth, 3, 2), edge(truth, 3, 5), edge(truth, 6, 5),
                                      edge(truth, 0, 1)};
  edges[4].confidence = 0.4;
  const PoseGraphResult result = optimize_pose_graph(7, edges);
  EXPECT_EQ(result.num_groups, 3u);
  EXPECT_EQ(result.group, (std::vector<std::size_t>{2, 1, 0, 0, 1, 0, 0}));
  EXPECT_EQ(result.edges[4].use, EdgeUse::LowConfidence);
  for (const std::size_t first : {0, 1, 2}) {
    EXPECT_TRUE(result.T_world_scan[first].matrix() == Eigen::Matrix4d::Identity()) << "bit for bit";
    for (std::size_t i = 0; i < 7; ++i) {
      if (result.group[i] != result.group[first]) continue;
      EXPECT_TRUE(result.T_world_scan[i].isApprox(truth[first].inverse() * truth[i], 1e-12));
    }
  }
}

TEST(PoseGraph, NoEdgesNoScansOneScan) {
  EXPECT_EQ(optimize_pose_graph(0, {}).num_groups, 0u);
  const PoseGraphResult one = optimize_pose_graph(1, {});
  EXPECT_EQ(one.num_groups, 1u);
  EXPECT_TRUE(one.T_world_scan[0].matrix() == Eigen::Matrix4d::Identity());
  EXPECT_EQ(optimize_pose_graph(3, {}).group, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(PoseGraph, UnitsDoNotMatter) {
  const auto truth = ring(12);
  const auto edges = ring_edges(truth, 3, 1.0);
  const PoseGraphResult metres = optimize_pose_graph(12, edges);
  auto scaled = edges;
  for (PoseGraphEdge& e : scaled) {
    e.T_target_source.translation() *= 1000.0;
    Vector6 units;
    units << 1, 1, 1, 1000, 1000, 1000;
    e.covariance = units.asDiagonal() * e.covariance * units.asDiagonal();
  }
  const PoseGraphResult millimetres = optimize_pose_graph(12, scaled);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_LT(angle_between(metres.T_world_scan[i], millimetres.T_world_scan[i]), 1e-10);
    EXPECT_LT((1000.0 * metres.T_world_scan[i].translation() - millimetres.T_world_scan[i].translation()).norm(), 1e-7);
  }
  EXPECT_NEAR(metres.chi_sq_after, millimetres.chi_sq_after, 1e-8 * metres.chi_sq_after);
}

TEST(PoseGraph, SameForAnyNumberOfThreads) {
  const auto truth = ring(12);
  auto edges = ring_edges(truth, 3, 1.0);
  edges.push_back(wrong_edge(1, 7));
  testing::expect_same_for_any_number_of_threads([&](const RunContext& context) {
    std::vector<double> numbers;
    for (const RigidTransform& T : optimize_pose_graph(12, edges, {}, context).T_world_scan) {
      numbers.insert(numbers.end(), T.data(), T.data() + 16);
    }
    return numbers;
  });
}

TEST(PoseGraph, RefusesWhatMakesNoSense) {
  const auto truth = ring(3);
  const auto refuse = [&](auto&& spoil) {
    std::vector<PoseGraphEdge> edges = {edge(truth, 0, 1), edge(truth, 1, 2)};
    spoil(edges[1]);
    try {
      (void)optimize_pose_graph(3, edges);
      ADD_FAILURE() << "accepted";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("edge 1"), std::string::npos) << error.what();
    }
  };
  refuse([](PoseGraphEdge& e) { e.source = 3; });
  refuse([](PoseGraphEdge& e) { e.source = e.target; });
  refuse([](PoseGraphEdge& e) { e.confidence = 1.1; });
  refuse([](PoseGraphEdge& e) { e.confidence = std::nan(""); });
  refuse([](PoseGraphEdge& e) { e.covariance(2, 2) = 0.0; });
  refuse([](PoseGraphEdge& e) { e.covariance(2, 2) = std::nan(""); });
  refuse([](PoseGraphEdge& e) { e.T_target_source.translation().x() = std::numeric_limits<double>::infinity(); });
  EXPECT_THROW((void)measure_disagreement(edge(truth, 1, 2), std::span(truth).first(2)), InvalidInput);
  PoseGraphOptions beyond;
  beyond.min_confidence = 2.0;
  EXPECT_THROW((void)optimize_pose_graph(3, {}, beyond), InvalidInput);
  std::stop_source stop;
  stop.request_stop();
  const std::vector<PoseGraphEdge> edges = {edge(truth, 0, 1), edge(truth, 1, 2), edge(truth, 0, 2)};
  EXPECT_THROW((void)optimize_pose_graph(3, edges, {}, {0, stop.get_token(), {}}), Cancelled);
}

}  // namespace
}  // namespace shapelight
