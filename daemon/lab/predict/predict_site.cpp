#include "daemon/lab/predict/predict_site.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rayloc {
namespace {

constexpr double kMinPointStep = 0.4;  // [m], chosen: a finer grid adds no information
constexpr double kUsualPlaces = 60.0;  // count, chosen: 180 bursts, so shares to 4 %

PredictionOptions reported_to(const Observer& observer,
                              const char* stage,
                              PredictionOptions options) {
  options.progress = [&observer, stage](double share) { observer.progress(share, stage); };
  return options;
}

}  // namespace

Expected<void> check_prediction(const SitePredictionOptions& options) {
  const int mhz = options.plan.bandwidth_mhz;
  if (mhz != 0 && mhz != 20 && mhz != 40 && mhz != 80 && mhz != 160) {
    return make_error(ErrorKind::kUsage, "--bandwidth is 20, 40, 80 or 160 MHz");
  }
  return {};
}

Expected<SitePrediction> predict_site(const Site& site,
                                      const SitePredictionOptions& options,
                                      const Observer& observer) {
  RAYLOC_TRY(check_prediction(options));
  auto room = planned_room(site, options.plan);
  RAYLOC_TRY(room);
  SitePrediction predicted;
  predicted.room = std::make_shared<const RoomModel>(*std::move(room));
  predicted.options = options.prediction;
  predicted.options.progress = nullptr;
  predicted.options.bandwidth_mhz =
      options.plan.bandwidth_mhz != 0 ? options.plan.bandwidth_mhz : site.carrier.bandwidth_mhz;
  predicted.options.frames =
      static_cast<std::size_t>(std::max(1.0, std::floor(options.frames_per_burst())));
  predicted.received_share = std::min(1.0, options.frames_per_burst());
  const double step =
      options.step == 0.0
          ? std::max(kMinPointStep, std::sqrt(predicted.room->area() / kUsualPlaces))
          : options.step;
  predicted.places = predicted_places(*predicted.room, step);
  if (predicted.places.empty()) {
    return make_error(ErrorKind::kUsage, "--step: no place of such a lattice is in the room");
  }
  auto prediction = predict(
      predicted.room, predicted.places, reported_to(observer, "predicting", predicted.options));
  RAYLOC_TRY(prediction);
  predicted.prediction = *std::move(prediction);
  return predicted;
}

Expected<std::vector<Proposal>> propose_changes(const SitePrediction& predicted,
                                                const ProposalOptions& which,
                                                const Observer& observer) {
  return proposals(*predicted.room,
                   predicted.places,
                   reported_to(observer, "comparing", predicted.options),
                   which);
}

}  // namespace rayloc
