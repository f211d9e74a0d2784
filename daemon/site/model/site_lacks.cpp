#include "daemon/site/model/site_lacks.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

struct Uncalibrated {
  std::string access_point;
  std::string problem;
};

std::vector<Uncalibrated> uncalibrated(const RoomModel& room,
                                       std::span<const std::size_t> received) {
  std::vector<Uncalibrated> all;
  for (const std::size_t index : received) {
    const RoomAccessPoint& ap = room.access_points[index];
    if (std::string problem = calibration_problem(room, ap); !problem.empty()) {
      all.push_back({ap.id, std::move(problem)});
    }
  }
  return all;
}

std::string obstacle(const Site& site, const std::vector<Uncalibrated>& all) {
  std::string who;
  for (const Uncalibrated& one : all) {
    who += (who.empty() ? "" : ", ") + one.access_point;
  }
  const bool is_whole_site = all.size() == site.access_points.size();
  return "nothing can be located: " +
         (is_whole_site ? std::string("the site is not calibrated")
                        : "the access points in use are not calibrated (" + who + ")") +
         "; see `rayloc calibrate --help`, with the site " + site.directory.string();
}

bool has_fixed_transmitter(const Site& site) {
  return std::any_of(site.transmitters.begin(), site.transmitters.end(), [](const auto& one) {
    return one.role == TransmitterRole::kFixed;
  });
}

}  // namespace

std::vector<std::string> SiteLacks::all() const {
  std::vector<std::string> all = obstacles;
  all.insert(all.end(), warnings.begin(), warnings.end());
  return all;
}

SiteLacks site_lacks(const Site& site,
                     const RoomModel& room,
                     std::span<const std::size_t> received) {
  std::vector<std::size_t> every(site.access_points.size());
  std::iota(every.begin(), every.end(), 0U);
  const std::span<const std::size_t> asked =
      received.empty() ? std::span<const std::size_t>(every) : received;
  SiteLacks lacks;
  const std::vector<Uncalibrated> without = uncalibrated(room, asked);
  if (without.size() == asked.size()) {
    lacks.obstacles.push_back(obstacle(site, without));
  } else {
    for (const Uncalibrated& one : without) {
      lacks.warnings.push_back("access point " + one.access_point + " " + one.problem +
                               "; until then no position uses it");
    }
  }
  if (has_fixed_transmitter(site) && !site.reference_file) {
    lacks.warnings.emplace_back(
        "people are not looked for: there is a fixed transmitter, but no recording of the empty "
        "room with it; see `rayloc reference --help`");
  }
  return lacks;
}

}  // namespace rayloc
