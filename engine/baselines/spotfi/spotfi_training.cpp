#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/base/constants.h"
#include "engine/baselines/paths/phase_errors.h"
#include "engine/baselines/paths/turn.h"
#include "engine/baselines/spotfi/spotfi.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

// Every third point suffices for the spread of phases; powers are cheap. A count.
constexpr std::size_t kPhaseEvery = 3;

bool is_constant(const TrainingInput& input, const MacAddress& transmitter) {
  return std::find(input.constant_power.begin(), input.constant_power.end(), transmitter) !=
         input.constant_power.end();
}

AccessPointTraining train_access_point(const TrainingInput& input,
                                       std::size_t access_point,
                                       const ToneComb& comb,
                                       const DirectPathOptions& options) {
  const RoomModel& room = *input.room;
  const RoomAccessPoint& ap = room.access_points[access_point];
  const double wavelength = kSpeedOfLight / room.grid.centre_hz;
  AccessPointTraining learned;
  learned.id = ap.id;
  std::vector<double> errors;
  std::vector<PowerAtDistance> powers;
  std::vector<std::string> unused;
  for (std::size_t i = 0; i < input.points.size(); ++i) {
    const TrainingPoint& point = input.points[i];
    const auto burst = preprocess_burst(room, access_point, point.frames, {}, unused);
    if (!burst) {
      continue;
    }
    ++learned.points;
    if (burst->power_dbm && is_constant(input, burst->transmitter)) {
      powers.push_back({norm(point.position - ap.array.pose.position), *burst->power_dbm});
    }
    if (i % kPhaseEvery == 0) {
      if (const auto path = find_direct_path(
              room, access_point, point.frames, {comb, options, input.seed}, unused)) {
        errors.push_back(
            wrapped(path->psi - psi_of(ap.array, path->line, point.position, wavelength)));
      }
    }
  }
  const PhaseErrors spread = fit_phase_errors(errors);
  learned.sigma_psi = spread.sigma;
  learned.outliers = spread.outliers;
  learned.path_loss = fit_path_loss_law(powers);
  return learned;
}

}  // namespace

Expected<std::shared_ptr<const Training>> train_spotfi(const TrainingInput& input) {
  const SpotfiOptions options = spotfi_options(input.values);
  RAYLOC_TRY(Spotfi::create(input.room, options, nullptr));
  auto training = std::make_shared<Training>();
  training->method = "spotfi";
  training->calibration_id = input.room->calibration_id;
  training->constant_power = input.constant_power;
  const ToneComb comb = tone_comb(input.room->grid);
  const std::size_t count = input.room->access_points.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (calibration_problem(*input.room, input.room->access_points[i]).empty()) {
      auto learned = train_access_point(input, i, comb, options.path);
      if (learned.points > 0) {
        training->access_points.push_back(std::move(learned));
      }
    }
    if (input.progress) {
      input.progress({static_cast<double>(i + 1) / static_cast<double>(count), {}});
    }
  }
  if (training->access_points.empty()) {
    return bad_input("no access point of the site received the survey");
  }
  return training;
}

}  // namespace rayloc
