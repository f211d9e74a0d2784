#include "engine/baselines/paths/living_line.h"

#include <numeric>
#include <utility>

#include "engine/room/preprocess_burst.h"

namespace rayloc {

std::optional<AntennaLine> living_line(const RoomAccessPoint& access_point,
                                       const BurstObservation& burst,
                                       std::vector<std::string>& warnings) {
  std::vector<std::size_t> elements(access_point.rx_chains.size());
  std::iota(elements.begin(), elements.end(), std::size_t{0});
  if (const auto dead = dead_chain(burst)) {
    elements.erase(elements.begin() + static_cast<std::ptrdiff_t>(dead->row));
  }
  if (elements.size() < 2) {
    warnings.push_back(access_point.id + " has " + std::to_string(elements.size()) +
                       " usable antenna: a bearing needs 2");
    return std::nullopt;
  }
  auto line = antenna_line(access_point.array, std::move(elements));
  if (!line) {
    warnings.push_back(access_point.id +
                       ": its antennas are not a line of equal steps along its y: no bearing");
  }
  return line;
}

Eigen::MatrixXcd along(const AntennaLine& line,
                       const BurstObservation& burst,
                       const std::vector<std::size_t>& tones) {
  Eigen::MatrixXcd h(static_cast<Eigen::Index>(line.element.size()),
                     static_cast<Eigen::Index>(tones.size()));
  for (std::size_t m = 0; m < line.element.size(); ++m) {
    for (std::size_t k = 0; k < tones.size(); ++k) {
      h(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(k)) =
          burst.value(line.element[m], tones[k]);
    }
  }
  return h;
}

}  // namespace rayloc
