// CellBelief: probability of a device in each cell of a room, combined one access point at a time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rayloc {

class CellBelief {
 public:
  explicit CellBelief(std::size_t cells) : log_weight_(cells) {}

  // log_likelihood: [cell], tempered. With probability `wrong` it has no information on the place.
  void receive(std::span<const double> log_likelihood, double wrong);

  // [cell]: ln of the probability that the device is in the cell; the probabilities sum to 1.
  std::vector<double> log_probability() const;

 private:
  std::vector<double> log_weight_;
};

}  // namespace rayloc
