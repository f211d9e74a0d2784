#include "engine/calibrate/check/array_mistakes.h"
#include "engine/base/constants.h"
#include "engine/base/six_digit_text.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace rayloc {
namespace {

// In degrees, above -180 and up to 180, without rounding errors of the conversion to radians.
double degrees(double angle) {
  const double rotated = std::remainder(angle / kDegree, 360.0);
  const double rounded = std::round(rotated * 1e6) / 1e6 + 0.0;
  return rounded <= -180.0 ? rounded + 360.0 : rounded;
}

std::string list_of(const RoomAccessPoint& ap, const std::vector<std::size_t>& order) {
  std::string text;
  for (const std::size_t i : order) {
    text += (text.empty() ? "" : ", ") + std::to_string(ap.rx_chains[i]);
  }
  return text;
}

// `order`: the chain to which each antenna, in the order of the site, is actually wired.
ArrayMistake in_order(const RoomAccessPoint& ap, const std::vector<std::size_t>& order) {
  ArrayMistake mistake{"", "", ap.array};
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < order.size(); ++i) {
    mistake.array.element_offset[order[i]] = ap.array.element_offset[i];
    if (order[i] != i) {
      moved.push_back(i);
    }
  }
  std::vector<std::size_t> stated(order.size());
  std::iota(stated.begin(), stated.end(), std::size_t{0});
  if (moved.size() == 2) {
    const std::string a = std::to_string(ap.rx_chains[moved.front()]);
    const std::string b = std::to_string(ap.rx_chains[moved.back()]);
    mistake.meaning = "with cores " + a + " and " + b + " exchanged";
    mistake.remedy = "core = " + b + " in place of core = " + a + ", and the reverse";
  } else {
    mistake.meaning = "with its antennas wired to cores " + list_of(ap, order) + " instead of " +
                      list_of(ap, stated);
    mistake.remedy = "core = " + list_of(ap, order) + " for its antennas, in the order of the file";
  }
  return mistake;
}

ArrayMistake rotated(const RoomAccessPoint& ap) {
  ArrayMistake mistake{"rotated by 180 degrees", "", ap.array};
  double& yaw = mistake.array.pose.orientation.yaw;
  yaw += std::numbers::pi;
  mistake.remedy = "yaw_deg = " + six_digit_text(degrees(yaw)) + " instead of " +
                   six_digit_text(degrees(ap.array.pose.orientation.yaw));
  return mistake;
}

ArrayMistake mirrored(const RoomAccessPoint& ap) {
  ArrayMistake mistake{"with its antennas mirrored (counted from behind, or upside down)",
                       "the offsets of its antennas with the other sign of y",
                       ap.array};
  for (Vec3d& offset : mistake.array.element_offset) {
    offset.y = -offset.y;
  }
  return mistake;
}

void add_orders(const RoomAccessPoint& ap, std::vector<ArrayMistake>& mistakes) {
  std::vector<std::size_t> order(ap.rx_chains.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() <= kAllOrders) {
    while (std::next_permutation(order.begin(), order.end())) {
      mistakes.push_back(in_order(ap, order));
    }
    return;
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      std::swap(order[i], order[j]);
      mistakes.push_back(in_order(ap, order));
      std::swap(order[i], order[j]);
    }
  }
}

// True if it receives equally from all azimuths: upright, with a pattern of elevation alone.
bool is_round(const AntennaArray& array) {
  const AntennaPattern::Kind kind = array.pattern.kind();
  const bool round = kind == AntennaPattern::kIsotropic || kind == AntennaPattern::kDipole ||
                     kind == AntennaPattern::kHalfWaveDipole;
  return round && array.pose.orientation.pitch == 0.0 && array.pose.orientation.roll == 0.0;
}

}  // namespace

std::vector<ArrayMistake> mistakes_of_array(const RoomAccessPoint& access_point) {
  std::vector<ArrayMistake> mistakes;
  if (access_point.rx_chains.size() < 2) {
    return mistakes;
  }
  mistakes.push_back(rotated(access_point));
  mistakes.push_back(mirrored(access_point));
  add_orders(access_point, mistakes);
  return mistakes;
}

bool share_rays(const AntennaArray& a, const AntennaArray& b) {
  const Orientation& p = a.pose.orientation;
  const Orientation& q = b.pose.orientation;
  return (is_round(a) && is_round(b)) || (p.yaw == q.yaw && p.pitch == q.pitch && p.roll == q.roll);
}

}  // namespace rayloc
