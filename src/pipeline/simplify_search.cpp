#include "pipeline/simplify_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "shapelight/core/error.hpp"

namespace shapelight::pipeline {
namespace {

constexpr double kTinyShare = 1e-12;  // of the bound: stands in for an error of 0 on a logarithmic scale
constexpr double kOvershoot = 1.3;    // steps go this much past the estimate, so that a bracket soon closes
constexpr double kMargin = 0.15;      // share of the bracket that a secant keeps away from its ends

struct Tried {
  std::size_t count;
  double error;
};

class Search {
 public:
  Search(double bound, const CountSearch& search) : bound_(bound), search_(search), floor_(search.least) {}

  void note(const Tried& tried) {
    std::optional<Tried>& side = tried.error <= bound_ ? good_ : bad_;
    const bool better = !side || (tried.error <= bound_ ? tried.count < side->count : tried.count > side->count);
    if (better) side = tried;
  }
  void note_unreachable(std::size_t least) { floor_ = std::max(floor_, least); }

  [[nodiscard]] const std::optional<Tried>& good() const { return good_; }
  [[nodiscard]] bool is_done() const {
    if (!good_) return false;
    const std::size_t below = bad_ ? bad_->count + 1 : floor_;
    return good_->count <= below ||
           (bad_ && static_cast<double>(good_->count) <= (1.0 + search_.precision) * static_cast<double>(bad_->count));
  }
  [[nodiscard]] std::size_t next() const {
    if (!good_ && !bad_) return clamp(static_cast<double>(search_.guess));
    if (good_ && bad_) return between(*bad_, *good_);
    // The error of a surface falls about as 1 / count.
    const Tried& last = good_ ? *good_ : *bad_;
    const double step = relative(last.error) * (good_ ? 1.0 / kOvershoot : kOvershoot);
    return clamp(static_cast<double>(last.count) * std::clamp(step, 0.05, 20.0));
  }

 private:
  [[nodiscard]] double relative(double error) const { return std::max(error / bound_, kTinyShare); }
  [[nodiscard]] std::size_t clamp(double count) const {
    const std::size_t low = bad_ ? bad_->count + 1 : floor_;
    const std::size_t high = good_ ? good_->count - 1 : search_.most;
    return static_cast<std::size_t>(
        std::clamp(std::round(count), static_cast<double>(std::min(low, high)), static_cast<double>(high)));
  }
  [[nodiscard]] std::size_t between(const Tried& bad, const Tried& good) const {
    const double low = std::log(static_cast<double>(bad.count)), high = std::log(static_cast<double>(good.count));
    const double above = std::log(relative(bad.error)), below = std::log(relative(good.error));
    const double share = above > below ? above / (above - below) : 0.5;
    return clamp(std::exp(low + std::clamp(share, kMargin, 1.0 - kMargin) * (high - low)));
  }

  double bound_;
  const CountSearch& search_;
  std::size_t floor_;
  std::optional<Tried> good_, bad_;
};

}  // namespace

FoundCount find_count(double bound, const CountSearch& settings, const ErrorOfCount& error_of) {
  Search search(bound, settings);
  std::size_t tries = 0;
  while (tries < settings.max_tries && !search.is_done()) {
    const std::size_t count = search.next();
    ++tries;
    try {
      search.note({count, error_of(count)});
    } catch (const TargetUnreachable& error) {
      const auto reachable = static_cast<std::size_t>(error.reachable());
      if (reachable <= count) throw;
      search.note_unreachable(reachable);
    }
  }
  if (search.good()) return {search.good()->count, search.good()->error, tries};
  const double error = error_of(settings.most);
  if (error <= bound) return {settings.most, error, tries + 1};
  throw TargetUnreachable(
      fmt::format("a distance of {:.6g} asked for, but {} vertices, all there are, come within {:.6g}", bound,
                  settings.most, error),
      settings.most);
}

}  // namespace shapelight::pipeline
