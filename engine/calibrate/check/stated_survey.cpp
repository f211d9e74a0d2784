#include "engine/calibrate/check/stated_survey.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "engine/calibrate/check/array_mistakes.h"

namespace rayloc {
namespace {

// The measurement of `from`'s chains in the order of `to`'s; empty if the chains differ.
std::vector<std::complex<double>> reordered(const std::vector<std::complex<double>>& h,
                                            const RoomAccessPoint& from,
                                            const RoomAccessPoint& to,
                                            std::size_t tones) {
  if (h.empty() || from.rx_chains.size() != to.rx_chains.size()) {
    return {};
  }
  std::vector<std::complex<double>> result;
  for (const std::uint8_t rx_chain : to.rx_chains) {
    const auto found = std::find(from.rx_chains.begin(), from.rx_chains.end(), rx_chain);
    if (found == from.rx_chains.end()) {
      return {};
    }
    const auto row =
        h.begin() + (found - from.rx_chains.begin()) * static_cast<std::ptrdiff_t>(tones);
    result.insert(result.end(), row, row + static_cast<std::ptrdiff_t>(tones));
  }
  return result;
}

}  // namespace

StatedSurvey::StatedSurvey(const RoomModel& room, std::span<const CalibrationPoint> points)
    : room_(room), points_(points) {
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    received_.push_back(receive_stated(room, ap));
    stated_.push_back(evaluated(received_.back(), room.access_points[ap].array));
  }
}

StatedSurvey::Received StatedSurvey::receive(const RoomModel& room,
                                             std::size_t access_point,
                                             const Rows& rows,
                                             const std::function<Vec3d(std::size_t)>& place) const {
  std::vector<CalibrationSample> samples;
  std::vector<std::size_t> point;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    auto h = rows(i);
    if (!h.empty()) {
      samples.push_back({place(i), std::move(h)});
      point.push_back(i);
    }
  }
  return {std::move(point), AccessPointCalibrator(room, access_point, std::move(samples))};
}

StatedSurvey::Received StatedSurvey::receive_stated(const RoomModel& room,
                                                    std::size_t access_point) const {
  return receive(
      room,
      access_point,
      [&](std::size_t i) { return points_[i].h.at(access_point); },
      [&](std::size_t i) { return place(i); });
}

Correlations StatedSurvey::of_points(const Received& received, const Correlations& samples) const {
  Correlations result(points_.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    result[received.point[i]] = samples[i];
  }
  return result;
}

Correlations StatedSurvey::evaluated(const Received& received, const AntennaArray& array) const {
  return of_points(received, received.calibrator.crossed_correlations(offsets_of(array)));
}

bool StatedSurvey::is_recorded(std::size_t access_point) const {
  return !received_[access_point].point.empty();
}

std::vector<PointFit> StatedSurvey::fits() const {
  std::vector<PointFit> fits;
  for (std::size_t ap = 0; ap < received_.size(); ++ap) {
    const auto fit = received_[ap].calibrator.fit_gains();
    if (!fit) {
      continue;
    }
    const Correlations each =
        of_points(received_[ap], received_[ap].calibrator.correlations(&*fit));
    for (std::size_t i = 0; i < each.size(); ++i) {
      if (each[i]) {
        fits.push_back({i, ap, *each[i], *each[i], 0.0});
      }
    }
  }
  return fits;
}

Correlations StatedSurvey::other(const Meant& meant) const {
  const auto& aps = room_.access_points;
  const AntennaArray& stated = aps[meant.pose].array;
  const AntennaArray& array = meant.array ? *meant.array : stated;
  const bool own = meant.recorded == meant.pose && !meant.place;
  if (own && share_rays(array, stated)) {
    return evaluated(received_[meant.pose], array);
  }
  RoomModel room = room_;
  room.access_points[meant.pose].array = array;
  const auto rows = [&](std::size_t i) {
    return reordered(
        points_[i].h.at(meant.recorded), aps[meant.recorded], aps[meant.pose], room_.grid.size());
  };
  const auto at = [&](std::size_t i) { return meant.place ? meant.place(i) : place(i); };
  return evaluated(receive(room, meant.pose, rows, at), array);
}

Correlations StatedSurvey::by_chance(const Meant& meant) const {
  Meant displaced = meant;
  displaced.place = [&](std::size_t i) {
    const std::size_t far = (i + points_.size() / 2) % points_.size();
    return meant.place ? meant.place(far) : place(far);
  };
  return other(displaced);
}

Correlations StatedSurvey::at_carrier(std::size_t access_point, double centre_hz) const {
  const Received& received = received_[access_point];
  const auto offsets = offsets_of(room_.access_points[access_point].array);
  return of_points(received,
                   received.calibrator.at_carrier(centre_hz).crossed_correlations(offsets));
}

}  // namespace rayloc
