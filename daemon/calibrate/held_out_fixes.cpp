#include "daemon/calibrate/held_out_fixes.h"

#include <array>
#include <cmath>
#include <utility>

#include "daemon/evaluate/error_statistics.h"
#include "engine/localize/localizer.h"

namespace rayloc {
namespace {

constexpr std::size_t kLeastFixes = 10;
constexpr double kConfidence = 0.95;

HeldOutFixes fixes_with(const Localizer& localizer,
                        std::span<const HeldOutSpot> spots,
                        double temper) {
  HeldOutFixes result;
  result.temper = temper;
  result.points = spots.size();
  std::vector<double> errors;
  for (const HeldOutSpot& spot : spots) {
    const auto estimate = localizer.locate(spot.frames, temper);
    if (!estimate.position) {
      continue;
    }
    const double error =
        std::hypot(estimate.position->x - spot.position.x, estimate.position->y - spot.position.y);
    ++result.fixes;
    result.within_accuracy += error <= estimate.accuracy_m ? 1U : 0U;
    errors.push_back(error);
  }
  result.median_error_m = errors.empty() ? 0.0 : percentile(std::move(errors), 0.5);
  return result;
}

}  // namespace

Expected<std::vector<HeldOutFixes>> fit_temper(std::shared_ptr<const RoomModel> room,
                                               std::span<const HeldOutSpot> spots) {
  const double usual = room->temper;
  const auto localizer = Localizer::create(std::move(room), {});
  if (!localizer) {
    return tl::make_unexpected(localizer.error());
  }
  if (spots.size() < kLeastFixes) {
    return std::vector<HeldOutFixes>{fixes_with(*localizer, spots, usual)};
  }
  std::vector<HeldOutFixes> tried;
  for (const double exponent : {1.0, 0.8, 0.6, 0.45, 0.3, 0.2, 0.13, 0.09, 0.06}) {
    tried.push_back(fixes_with(*localizer, spots, exponent));
    if (tried.back().fixes < kLeastFixes) {
      return std::vector<HeldOutFixes>{fixes_with(*localizer, spots, usual)};
    }
    if (static_cast<double>(tried.back().within_accuracy) >=
        kConfidence * static_cast<double>(tried.back().fixes)) {
      break;
    }
  }
  return tried;
}

}  // namespace rayloc
