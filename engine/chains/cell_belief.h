// CellBelief: how likely a device is in every cell of a room, by one access point after the other.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rayloc {

class CellBelief {
 public:
  explicit CellBelief(std::size_t cells) : log_weight_(cells) {}

  // log_likelihood: [cell], tempered. With a probability of `wrong` it says nothing of the place.
  void hear(std::span<const double> log_likelihood, double wrong);

  // [cell]: ln of how likely the device is there; their sum is 1.
  std::vector<double> log_probability() const;

 private:
  std::vector<double> log_weight_;
};

}  // namespace rayloc
