#include "daemon/cli/feed/message_filter.h"

#include <algorithm>
#include <cmath>

#include "daemon/messages/topic.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {
namespace {

const v1::Target* target_of(const v1::Envelope& envelope) {
  switch (envelope.body_case()) {
    case v1::Envelope::kLocation:
      return &envelope.location().target();
    case v1::Envelope::kCompared:
      return &envelope.compared().target();
    case v1::Envelope::kTrack:
      return &envelope.track().target();
    case v1::Envelope::kZone:
      return &envelope.zone().target();
    default:
      return nullptr;
  }
}

bool is_one_of(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_target(const std::vector<std::string>& wanted, const v1::Target* target) {
  return target != nullptr && (is_one_of(wanted, target_component(*target)) ||
                               (!target->name().empty() && is_one_of(wanted, target->name())));
}

bool is_in_zone(const MessageFilter& filter, const v1::Envelope& envelope) {
  if (envelope.has_zone()) {
    return is_one_of(filter.zones, envelope.zone().zone());
  }
  const auto& zones = envelope.location().zones();
  return std::any_of(zones.begin(), zones.end(), [&](const v1::ZoneProbability& zone) {
    return zone.probability() >= filter.zone_probability && is_one_of(filter.zones, zone.zone());
  });
}

bool is_of_kind(const std::string& kind, const v1::Envelope& envelope) {
  return envelope.has_location() &&
         envelope.location().kind() ==
             (kind == "filtered" ? v1::LOCATION_KIND_FILTERED : v1::LOCATION_KIND_SNAPSHOT);
}

// Probability of the heaviest hypothesis and those of the same place: a maximum
// that is stated as its peak and its base. Below 0 where no hypothesis is stated.
double confidence_of(const v1::Location& location) {
  constexpr double kSamePlace = 0.3;  // [m]
  if (location.hypotheses().empty()) {
    return -1.0;
  }
  const v1::Point& heaviest = location.hypotheses(0).position();
  double sum = 0.0;
  for (const v1::Hypothesis& one : location.hypotheses()) {
    const double away =
        std::hypot(one.position().x() - heaviest.x(), one.position().y() - heaviest.y());
    sum += away < kSamePlace ? one.weight() : 0.0;
  }
  return sum;
}

}  // namespace

bool MessageFilter::passes(const v1::Envelope& envelope) const {
  if (!targets.empty() && !is_target(targets, target_of(envelope))) {
    return false;
  }
  if (!kind.empty() && !is_of_kind(kind, envelope)) {
    return false;
  }
  if (!zones.empty() && !is_in_zone(*this, envelope)) {
    return false;
  }
  const v1::Location& location = envelope.location();  // empty for other messages
  if (max_accuracy && !(location.has_accuracy_m() && location.accuracy_m() <= *max_accuracy)) {
    return false;
  }
  return !min_confidence || confidence_of(location) >= *min_confidence;
}

}  // namespace rayloc::cli
