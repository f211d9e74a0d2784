// MessageFilter: selects the messages that `rayloc sub` prints.
//
// Conditions of every kind must hold; one of several targets or zones suffices. A
// condition does not hold for a message without the tested field: any condition excludes
// heartbeats, and one on locations (kind, accuracy, confidence) excludes events as well.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rayloc::v1 {
class Envelope;
}  // namespace rayloc::v1

namespace rayloc::cli {

struct MessageFilter {
  std::vector<std::string> targets = {};      // as in the topic, or the name in site.toml
  std::string kind = {};                      // "snapshot", "filtered"; empty: both
  std::vector<std::string> zones = {};        // names
  double zone_probability = 0.5;              // minimum probability of a location in a zone
  std::optional<double> max_accuracy = {};    // [m]
  std::optional<double> min_confidence = {};  // of the heaviest hypothesis and those beside it

  bool passes(const v1::Envelope& envelope) const;
};

}  // namespace rayloc::cli
