#include "shapelight/core/run_context.hpp"

#include <cmath>
#include <string>

#include "shapelight/core/error.hpp"

namespace shapelight {

RunContext RunContext::phase(double begin, double end, std::string_view name) const {
  check();
  RunContext inner{max_threads, stop, {}};
  if (progress) {
    progress(begin, name);
    inner.progress = [outer = progress, begin, end, own = std::string(name)](double fraction, std::string_view inside) {
      outer(std::lerp(begin, end, fraction), inside.empty() ? std::string_view(own) : inside);
    };
  }
  return inner;
}

void RunContext::check() const {
  if (stop.stop_requested()) throw Cancelled();
}

}  // namespace shapelight
