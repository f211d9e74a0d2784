#include "daemon/lab/reference/people_day.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "engine/base/constants.h"
#include "engine/observe/chain_gains.h"
#include "engine/person/calibrate/another_day.h"
#include "engine/person/calibrate/occupied_room.h"
#include "engine/person/calibrate/person_fit.h"

namespace rayloc {
namespace {

// [rad], 30 degrees, and a count of standard deviations: a smaller rotation is within the error of
// a mean over places of people. Chosen: in a closet of 3 x 2.4 m, with 8 to 12 places, people of
// the same day remained below 0.9 of the larger limit, those of another day were above 1.2 of it at
// each access point, and above 3.5 at one.
constexpr double kMinRotation = 30.0 * kDegree;
constexpr double kRotationSigmas = 4.5;
// Number of frames of people averaged for each access point.
constexpr std::size_t kMaxPeopleFrames = 1024;
constexpr const char* kRemedy = "give the empty room of that day: --people-empty [AP=]FILE";

std::optional<RotatedChain> rotation_of(const RoomModel& room,
                                        const PersonLink& link,
                                        const std::vector<CsiFrame>& frames) {
  BurstOptions options;
  options.max_frames = kMaxPeopleFrames;
  std::vector<std::string> ignored;  // the fit reports them by point
  auto people = receive_background(room, link.access_point, frames, options, ignored);
  if (!people) {
    return std::nullopt;
  }
  const ChainGains& gains = room.access_points[link.access_point].gains;
  std::vector<std::complex<double>> empty = link.empty;
  apply_coupling(gains, people->h);
  apply_coupling(gains, empty);
  const auto chains = compare_days(room.grid, people->h, empty);
  return chains ? find_rotated(*chains) : std::nullopt;
}

void append(std::string& list, const std::string& entry) {
  list += (list.empty() ? "" : ", ") + entry;
}

}  // namespace

std::optional<RotatedChain> find_rotated(const RotatedChains& chains) {
  std::optional<RotatedChain> largest;
  for (std::size_t row = 1; row < chains.turn.size(); ++row) {
    const double angle = std::abs(std::arg(chains.turn[row]));
    const double sigma = std::hypot(chains.sigma[row], chains.sigma[0]);
    if (angle > std::max(kMinRotation, kRotationSigmas * sigma) &&
        (!largest || angle > largest->angle)) {
      largest = {row, angle};
    }
  }
  return largest;
}

Expected<void> check_people_day(const RoomModel& room,
                                const PersonReference& reference,
                                const std::vector<std::vector<CsiFrame>>& points) {
  std::vector<CsiFrame> frames;
  for (const std::vector<CsiFrame>& own : points) {
    frames.insert(frames.end(), own.begin(), own.end());
  }
  std::string rotated;
  for (const PersonLink& link : reference.links) {
    if (const auto chain = rotation_of(room, link, frames)) {
      const RoomAccessPoint& ap = room.access_points[link.access_point];
      append(rotated,
             fmt::format("{}: rx chain {} by {:.0f} degrees",
                         ap.id,
                         ap.rx_chains[chain->row],
                         kDegreesPerRadian * chain->angle));
    }
  }
  if (!rotated.empty()) {
    return bad_input("people were recorded with other chain phases than --capture (" + rotated +
                     "); " + kRemedy);
  }
  return {};
}

Expected<void> check_echo_factors(const RoomModel& room,
                                  const PersonReference& fitted,
                                  const std::vector<PersonPoint>& points) {
  std::string factors;
  for (std::size_t l = 0; l < fitted.links.size(); ++l) {
    const PersonLink& link = fitted.links[l];
    if (std::all_of(points.begin(), points.end(), [&](const PersonPoint& point) {
          return point.h[l].empty();
        })) {
      continue;  // no person was received: its factor is not fitted
    }
    if (!is_scale_at_limit(link.scale)) {
      return {};
    }
    append(
        factors,
        fmt::format("{}: {:.2f}", room.access_points[link.access_point].id, std::abs(link.scale)));
  }
  if (factors.empty()) {
    return {};
  }
  return bad_input("the echo factor of a person is at a limit of the fit at every access point (" +
                   factors +
                   "): people were recorded with other chain phases than --capture, or at other "
                   "places than the points; if it was another day, " +
                   kRemedy);
}

}  // namespace rayloc
