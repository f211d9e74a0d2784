#include "daemon/cli/calibration/fit_arguments.h"

namespace rayloc::cli {

Expected<void> check_fit_arguments(const CalibrateArguments& arguments) {
  if (arguments.captures.empty() || arguments.points.empty() || arguments.out.empty()) {
    return make_error(ErrorKind::kUsage,
                      "a calibration needs --capture, --points and --out; --plan needs the site "
                      "alone");
  }
  if (!(arguments.holdout >= 0.0 && arguments.holdout <= 0.8)) {
    return make_error(ErrorKind::kUsage, "--holdout is a share of the points from 0 to 0.8");
  }
  // Smaller errors would claim a survey more accurate than the carrier's wavelength can resolve.
  if (const auto& error = arguments.survey_error; error && !(*error >= 0.0005 && *error <= 0.1)) {
    return make_error(ErrorKind::kUsage, "--survey-error is from 0.0005 to 0.1 m");
  }
  if (arguments.resume && arguments.method != "joint") {
    return make_error(ErrorKind::kUsage, "--resume goes on with the joint method only");
  }
  return {};
}

}  // namespace rayloc::cli
