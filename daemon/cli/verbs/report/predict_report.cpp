#include "daemon/cli/verbs/report/predict_report.h"

#include <string>

#include <spdlog/fmt/fmt.h>

#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

constexpr std::size_t kMaxConfused = 5;  // count, chosen: as many as a person reads

std::string place_text(const Vec3d& place) {
  return fmt::format("({:.1f}, {:.1f})", place.x, place.y);
}

}  // namespace

void print_prediction(const SitePrediction& predicted, std::size_t devices) {
  const Prediction& prediction = predicted.prediction;
  fmt::print("{} places, {} bursts of {} frames at each\n",
             prediction.places.size(),
             predicted.options.draws,
             predicted.options.frames);
  fmt::print(
      "error: median {:.3f} m, 90 % below {:.3f} m\n", prediction.median_m, prediction.p90_m);
  fmt::print("located at another place (more than {:.1f} m off): {:.1f} % of bursts\n",
             kAnotherPlace,
             100.0 * prediction.another_place);
  fmt::print("a device of {} is received in {:.0f} % of bursts\n",
             devices,
             100.0 * predicted.received_share);
  for (const ConfusedPlace& one : confused_places(prediction, kMaxConfused)) {
    fmt::print("looks alike: {} is taken for {} in {} of {} bursts\n",
               place_text(one.place),
               place_text(one.taken_for),
               one.count,
               one.draws);
  }
}

void print_proposals(const std::vector<Proposal>& found) {
  fmt::print("\nmisplaced  median  proposal\n");
  for (const Proposal& one : found) {
    fmt::print("{:7.1f} %  {:4.2f} m  {}\n",
               100.0 * one.prediction.another_place,
               one.prediction.median_m,
               printable(one.what));
  }
}

}  // namespace rayloc::cli
