#include "engine/paper/options.h"

#include <cmath>

namespace rayloc::paper {

LocalizerOptions person_options() {
  LocalizerOptions options;
  options.csi.delay_weight = 2.0;
  options.centre_weight = 2.0;
  options.descent.variance = 0.1;
  options.descent.alpha = 1.0;
  return options;
}

Expected<void> validate(const LocalizerOptions& options) {
  const auto refuse = [](const char* what) { return make_error(ErrorKind::kUsage, what); };
  const auto is_weight = [](double x) { return x >= 0.0 && std::isfinite(x); };
  if (!is_weight(options.csi.delay_weight) || !is_weight(options.centre_weight)) {
    return refuse("the weights of the paper's loss are 0 or more");
  }
  if (!(options.csi.floor > 0.0) || !std::isfinite(options.csi.floor)) {
    return refuse("the floor of the paper's loss is more than 0");
  }
  if (options.starts == 0) {
    return refuse("the paper's method takes 1 or more starts");
  }
  RAYLOC_TRY(validate(options.descent));
  return validate(options.csi.smoothing);
}

}  // namespace rayloc::paper
