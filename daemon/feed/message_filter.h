// MessageFilter: which messages `rayloc sub` prints.
//
// Conditions of every kind must hold; of several targets or zones one suffices. A condition that a
// message has nothing to say about does not hold: with any of them heartbeats are left out, with
// one of locations (kind, accuracy, confidence) events are as well.
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
  double zone_probability = 0.5;              // that a location needs to be in a zone
  std::optional<double> max_accuracy = {};    // [m]
  std::optional<double> min_confidence = {};  // of the heaviest hypothesis and those beside it

  bool passes(const v1::Envelope& envelope) const;
};

}  // namespace rayloc::cli
