// Registers pairs of scans whose motion is known, from many starts, on samples by many samplers: CSV to two files.
//
//   registration_experiment --runs RUNS.csv --samplings SAMPLINGS.csv
//       [--scans NAME SOURCE TARGET TRANSFORM]... [--mesh NAME FILE OVERLAP NOISE AZIMUTH]...
//       [--samplers shape-nb,shape,...] [--methods ficp,...] [--percent 10,5] [--starts 20] [--polished 2]
//       [--angles 5,20] [--pixels 240] [--export DIR]
//
// A sampler is a method of `shapelight sample` or `paper`, the literal paper's; its suffix -nb leaves out the border.
// Percent is the share of points KEPT, of both scans. The first `polished` starts of a cell are also polished and
// assessed on the full scans, which costs more than the registration itself. --export writes the samples, starts and
// truths for other programs.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/sample_graph.hpp"
#include "repeatability.hpp"
#include "scan_pairs.hpp"
#include "shapelight/core/error.hpp"
#include "shapelight/io/io.hpp"
#include "shapelight/registration/ficp.hpp"
#include "shapelight/registration/icp.hpp"
#include "shapelight/registration/soft_icp.hpp"

namespace shapelight::bench {
namespace {

const RunContext kOneThread{1, {}, {}};

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Plan {
  std::vector<std::vector<std::string>> scans, meshes;
  std::vector<std::string> samplers = {"shape-nb", "shape", "stratified", "random"};
  std::vector<std::string> methods = {"ficp", "ficp-pure", "softicp", "icp", "plane", "gicp"};
  std::vector<double> percents = {10, 5};
  std::vector<double> angles = {5, 20};
  int starts = 20;
  int polished = 2;
  int pixels = 240;
  std::string runs, samplings, exports;
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  for (const std::string& part : split(text)) values.push_back(std::stod(part));
  return values;
}

Plan parse(int argc, char** argv) {
  Plan plan;
  for (int i = 1; i < argc; ++i) {
    const std::string_view flag = argv[i];
    const auto take = [&](int count) {
      std::vector<std::string> words;
      for (; count > 0 && i + 1 < argc; --count) words.emplace_back(argv[++i]);
      if (count > 0) throw InvalidInput(fmt::format("{}: {} words are missing", flag, count));
      return words;
    };
    const auto next = [&] { return take(1).front(); };
    if (flag == "--scans")
      plan.scans.push_back(take(4));
    else if (flag == "--mesh")
      plan.meshes.push_back(take(5));
    else if (flag == "--samplers")
      plan.samplers = split(next());
    else if (flag == "--methods")
      plan.methods = split(next());
    else if (flag == "--percent")
      plan.percents = numbers(next());
    else if (flag == "--angles")
      plan.angles = numbers(next());
    else if (flag == "--starts")
      plan.starts = std::stoi(next());
    else if (flag == "--polished")
      plan.polished = std::stoi(next());
    else if (flag == "--pixels")
      plan.pixels = std::stoi(next());
    else if (flag == "--runs")
      plan.runs = next();
    else if (flag == "--samplings")
      plan.samplings = next();
    else if (flag == "--export")
      plan.exports = next();
    else
      throw InvalidInput(fmt::format("{}: unknown option", flag));
  }
  if (plan.runs.empty() || plan.samplings.empty()) throw InvalidInput("expected --runs FILE and --samplings FILE");
  return plan;
}

template <class E>
E by_name(std::string_view name) {
  for (const auto& [value, known] : enum_names(E{})) {
    if (known == name) return value;
  }
  throw InvalidInput(fmt::format("'{}' is unknown", name));
}

class Sampler {
 public:
  explicit Sampler(const std::string& name) {
    const bool skips = name.ends_with("-nb");
    const std::string base = skips ? name.substr(0, name.size() - 3) : name;
    const bool is_paper = base == "paper";
    options_ = sample_preset(is_paper ? Preset::Paper : Preset::Detail);
    options_.method = is_paper ? SamplingMethod::Shape : by_name<SamplingMethod>(base);
    options_.skip_boundary = skips;
  }

  // Indices of prepared.full, whose samples are set accordingly. Returns the CPU milliseconds of choosing, which for
  // method Shape are mostly those of the fields.
  double choose(Scan& scan, double percent, std::uint64_t seed, std::vector<Index>& chosen) {
    const SurfaceGraph& graph = scan.built.graph;
    std::size_t available = 0;
    for (std::size_t v = 0; v < graph.size(); ++v) {
      available += !graph.outlier[v] && !(options_.skip_boundary && graph.boundary[v]);
    }
    const auto wanted = static_cast<std::size_t>(std::llround(0.01 * percent * static_cast<double>(graph.size())));
    options_.seed = seed;
    const double start = cpu_ms();
    const SampleResult sampled =
        sample_graph(scan.built, scan.kind, {.count = std::min(available, wanted), .ratio = {}, .spacing = {}},
                     options_, kOneThread);
    const double cpu = cpu_ms() - start;
    set_samples(scan, sampled.indices, chosen);
    return cpu;
  }

 private:
  static void set_samples(Scan& scan, const std::vector<Index>& points, std::vector<Index>& chosen) {
    chosen.clear();
    std::vector<Vec3> position, normal;
    for (const Index point : points) {
      const Index place = scan.place_of_vertex[scan.built.graph.vertex_of_point[point]];
      chosen.push_back(place);
      position.push_back(scan.prepared.full.position[place]);
      normal.push_back(scan.prepared.full.normal[place]);
    }
    scan.prepared.samples = RegistrationCloud(std::move(position), std::move(normal), kOneThread);
  }

  SampleOptions options_;
};

RegistrationResult register_samples(const Pair& pair, RegistrationMethod method, const RigidTransform& start) {
  const RegistrationCloud &source = pair.source.prepared.samples, &target = pair.target.prepared.samples;
  const auto by_icp = [&](IcpMetric metric) {
    IcpOptions options;
    options.metric = metric;
    options.max_distance = 0.1 * pair.target.prepared.full.diagonal;
    return register_by_icp(source, target, start, options, kOneThread);
  };
  FicpOptions ficp;
  switch (method) {
    case RegistrationMethod::Icp:
      return by_icp(IcpMetric::Point);
    case RegistrationMethod::Plane:
      return by_icp(IcpMetric::Plane);
    case RegistrationMethod::Gicp:
      return by_icp(IcpMetric::Gicp);
    case RegistrationMethod::SoftIcp:
      return register_by_soft_icp(source, target, start, {}, kOneThread);
    case RegistrationMethod::FicpPure:
      ficp.start_lambda = ficp.lambda;
      break;
    case RegistrationMethod::Ficp:
      break;
  }
  return register_by_ficp(source, target, start, ficp, kOneThread);
}

// The tool's own last step, from where the method ended.
RegisterResult polish(const Pair& pair, RegistrationMethod method, const RigidTransform& T_target_source) {
  RigidTransform between_inputs = T_target_source;
  between_inputs.translation() = pair.target.prepared.origin + T_target_source.translation() -
                                 T_target_source.linear() * pair.source.prepared.origin;
  RegisterOptions options;
  options.method = method;
  options.max_distance = 0.1 * pair.target.prepared.full.diagonal;
  RegisterResult result =
      register_scans(pair.source.prepared, pair.target.prepared, between_inputs, options, kOneThread);
  result.T_target_source.translation() =
      result.T_target_source * pair.source.prepared.origin - pair.target.prepared.origin;
  return result;
}

class Experiment {
 public:
  explicit Experiment(const Plan& plan) : plan_(plan), runs_(plan.runs), samplings_(plan.samplings) {
    runs_ << "pair,truth,overlap,sampler,percent,method,start,start_deg,rotation_deg,shift,success,stop,iterations,"
             "inlier_ratio,cpu_ms,e_mu,e_delta,rc_share,truth_e_mu,truth_e_delta,polished_rotation_deg,"
             "polished_shift,polished_e_mu,polish_cpu_ms,confidence\n";
    samplings_ << "pair,truth,overlap,sampler,percent,source_points,target_points,source_samples,target_samples,"
                  "no_counterpart,hit,chance,close_hit,mutual,boundary,cpu_ms\n";
  }

  void add(Pair& pair) {
    truth_ = assess_pose(pair.source.prepared.full, pair.target.prepared.full, pair.T_target_source, {}, kOneThread);
    const std::vector<Start> starts = starting_poses(pair, plan_.starts, plan_.angles[0], plan_.angles[1]);
    for (const std::string& name : plan_.samplers) {
      Sampler sampler(name);
      for (const double percent : plan_.percents) {
        add_sampling(pair, sampler, name, percent);
        if (!plan_.exports.empty()) write_samples(pair, starts, name, percent);
        for (const std::string& method : plan_.methods) add_cell(pair, starts, name, percent, method);
        runs_.flush();
        samplings_.flush();
      }
    }
    fmt::print(stderr, "{}: {} and {} points, overlap {:.2f}\n", pair.name, pair.source.prepared.full.size(),
               pair.target.prepared.full.size(), pair.overlap);
  }

 private:
  void add_sampling(Pair& pair, Sampler& sampler, const std::string& name, double percent) {
    std::vector<Index> source, target;
    double cpu = sampler.choose(pair.source, percent, 1, source);
    cpu += sampler.choose(pair.target, percent, 2, target);
    const Repeatability r = measure_repeatability(pair, source, target);
    samplings_ << fmt::format("{},{},{:.3f},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.2f}\n",
                              pair.name, pair.truth, pair.overlap, name, percent, pair.source.prepared.full.size(),
                              pair.target.prepared.full.size(), source.size(), target.size(), r.no_counterpart, r.hit,
                              r.chance, r.close_hit, r.mutual, r.boundary, cpu);
  }

  // Few starts where each takes long: 20, then 3, then 1, taken evenly from the same list.
  [[nodiscard]] std::size_t stride(double percent, std::size_t count) const {
    const std::size_t wanted = percent <= 10 ? count : percent <= 25 ? 3 : 1;
    return std::max<std::size_t>(1, count / wanted);
  }

  void add_cell(const Pair& pair, const std::vector<Start>& starts, const std::string& sampler, double percent,
                const std::string& name) {
    const auto method = by_name<RegistrationMethod>(name);
    const std::size_t step = stride(percent, starts.size());
    int polished = plan_.polished;
    for (std::size_t i = step / 2; i < starts.size(); i += step) {
      const double begin = cpu_ms();
      const RegistrationResult result = register_samples(pair, method, starts[i].T_target_source);
      const double cpu = cpu_ms() - begin;
      const PoseError error = error_of(pair, result.T_target_source);
      runs_ << fmt::format("{},{},{:.3f},{},{},{},{},{:.3f},{:.5f},{:.6f},{},{},{},{:.4f},{:.3f}", pair.name,
                           pair.truth, pair.overlap, sampler, percent, name, i, starts[i].angle_deg, error.rotation_deg,
                           error.shift, error.is_success() ? 1 : 0, stop_reason_name(result.stop), result.iterations,
                           result.inlier_ratio, cpu);
      if (polished-- > 0)
        add_assessment(pair, method, result.T_target_source);
      else
        runs_ << ",,,,,,,,,,";
      runs_ << '\n';
    }
  }

  // On the full scans; lengths in point spacings of the target.
  void add_assessment(const Pair& pair, RegistrationMethod method, const RigidTransform& T_target_source) {
    const PreparedScan &source = pair.source.prepared, &target = pair.target.prepared;
    const ReciprocalError error = assess_pose(source.full, target.full, T_target_source, {}, kOneThread).reciprocal;
    const double begin = cpu_ms();
    const RegisterResult polished = polish(pair, method, T_target_source);
    const double cpu = cpu_ms() - begin;
    const PoseError left = error_of(pair, polished.T_target_source);
    const double unit = 1.0 / target.full.spacing;
    runs_ << fmt::format(",{:.5f},{:.5f},{:.4f},{:.5f},{:.5f},{:.5f},{:.6f},{:.5f},{:.2f},{:.3f}", unit * error.mean,
                         unit * error.std, error.share, unit * truth_.reciprocal.mean, unit * truth_.reciprocal.std,
                         left.rotation_deg, left.shift, unit * polished.assessment.reciprocal.mean, cpu,
                         polished.assessment.confidence);
  }

  // DIR/PAIR/SAMPLER-PERCENT/{source,target}.xyz and DIR/PAIR/{truth,starts,middle}.txt, all about the scans' middles.
  void write_samples(const Pair& pair, const std::vector<Start>& starts, const std::string& sampler,
                     double percent) const {
    const std::filesystem::path folder = std::filesystem::path(plan_.exports) / pair.name;
    const std::filesystem::path samples = folder / fmt::format("{}-{}", sampler, percent);
    std::filesystem::create_directories(samples);
    const auto write = [&](const char* name, const RegistrationCloud& cloud) {
      std::ofstream file(samples / name);
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Vec3 &p = cloud.position[i], &n = cloud.normal[i];
        file << fmt::format("{} {} {} {} {} {}\n", p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
      }
    };
    write("source.xyz", pair.source.prepared.samples);
    write("target.xyz", pair.target.prepared.samples);
    const auto rows = [](const RigidTransform& transform) {
      std::string text;
      for (int i = 0; i < 16; ++i) text += fmt::format("{:.17g} ", transform.matrix()(i / 4, i % 4));
      return text + "\n";
    };
    std::ofstream poses(folder / "starts.txt");
    for (const Start& start : starts) poses << rows(start.T_target_source);
    std::ofstream(folder / "truth.txt") << rows(pair.T_target_source);
    std::ofstream(folder / "middle.txt") << fmt::format("{} {} {} {}\n", pair.middle.x(), pair.middle.y(),
                                                        pair.middle.z(), pair.target.prepared.full.diagonal);
  }

  const Plan& plan_;
  std::ofstream runs_, samplings_;
  PoseAssessment truth_;
};

int run(int argc, char** argv) {
  const Plan plan = parse(argc, argv);
  Experiment experiment(plan);
  for (const auto& words : plan.scans) {
    Pair pair = read_pair(words[0], words[1], words[2], words[3]);
    experiment.add(pair);
  }
  for (const auto& words : plan.meshes) {
    Pair pair =
        scan_mesh(words[0], words[1], std::stod(words[2]), std::stod(words[3]), std::stod(words[4]), plan.pixels);
    experiment.add(pair);
  }
  return 0;
}

}  // namespace
}  // namespace shapelight::bench

int main(int argc, char** argv) {
  try {
    return shapelight::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "registration_experiment: {}\n", error.what());
    return 1;
  }
}
