#include "engine/likelihood/received_power.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/likelihood/observation_model.h"

namespace rayloc {

double traced_power_db(std::span<const Ray> rays, const ModelError& error) {
  RAYLOC_CHECK(!rays.empty());
  double power = 0.0;
  double first_length = rays.front().length;
  for (const Ray& ray : rays) {
    power += std::norm(ray.amplitude);
    first_length = std::min(first_length, ray.length);
  }
  return 10.0 * std::log10(power * (1.0 + diffuse_share(error, first_length)));
}

double ReceivedPower::log_likelihood(double traced_power_db) const {
  const double off = (traced_db - traced_power_db) / sigma_db;
  return -0.5 * off * off;
}

std::optional<ReceivedPower> received_power(const RoomAccessPoint& access_point,
                                            const BurstObservation& burst) {
  const auto& powers = access_point.powers;
  const auto known = std::find_if(powers.begin(), powers.end(), [&](const TransmitterPower& one) {
    return one.transmitter == burst.transmitter;
  });
  if (known == powers.end() || !burst.power_dbm) {
    return std::nullopt;
  }
  return ReceivedPower{*burst.power_dbm - known->offset_db, known->sigma_db};
}

}  // namespace rayloc
