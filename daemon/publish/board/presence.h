// Presence: where somebody was in the last hours, for how long. Of nobody in particular: what is
// kept is a sum for each quarter of a square metre, in memory alone, and is forgotten in time.
//
// Memory is bounded: kSlots slices of time, each with kMostCells cells; what comes to more is
// counted in `left_out`. Thread safety: one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "engine/base/timestamp.h"

namespace rayloc {

namespace v1 {
class Envelope;
}  // namespace v1

class Presence {
 public:
  static constexpr double kCell = 0.25;            // [m], along each side
  static constexpr std::size_t kSlots = 24;        // of time
  static constexpr std::size_t kMostCells = 1500;  // 94 m^2 in which somebody was within a slot

  // `kept`: how long, positive; it is forgotten slot by slot.
  explicit Presence(Duration kept) : kept_(kept) {}

  // Filtered estimates count from the one before of the same track; all else does not.
  void add(const v1::Envelope& envelope);

  struct Cell {
    double x = 0.0;  // its middle [m]
    double y = 0.0;
    double seconds = 0.0;
  };
  std::vector<Cell> cells(Timestamp now) const;
  Duration kept() const { return kept_; }
  std::uint64_t left_out() const { return left_out_; }

 private:
  using Place = std::pair<std::int32_t, std::int32_t>;
  struct Slot {
    std::int64_t number = 0;  // of its time, since 1970
    std::map<Place, double> seconds;
  };

  std::int64_t number_at(Timestamp time) const;
  void forget(Timestamp now);

  Duration kept_;
  std::array<Slot, kSlots> slots_;
  using Track = std::pair<int, std::uint64_t>;  // kind and number: both kinds count from 1
  std::map<Track, Timestamp> seen_;             // that were located just now
  std::uint64_t left_out_ = 0;
};

}  // namespace rayloc
