// Presence: the places and durations of all targets in the last hours, without identities: a sum
// for each quarter of a square metre, in memory only, which is discarded in time.
//
// Memory is bounded: kSlots slices of time, each with kMaxCells cells; the excess is counted in
// `left_out`. Thread safety: one thread.
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
  static constexpr double kCell = 0.25;           // [m], along each side
  static constexpr std::size_t kSlots = 24;       // slices of time
  static constexpr std::size_t kMaxCells = 1500;  // 94 m^2 occupied within a slot

  // `kept`: retention time, positive; data is discarded slot by slot.
  explicit Presence(Duration kept) : kept_(kept) {}

  // Filtered estimates count from the previous one of the same track; other messages are ignored.
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
    std::int64_t number = 0;  // number of its time slice, since 1970
    std::map<Place, double> seconds;
  };

  std::int64_t number_at(Timestamp time) const;
  void forget(Timestamp now);

  Duration kept_;
  std::array<Slot, kSlots> slots_;
  using Track = std::pair<int, std::uint64_t>;  // kind and number: both kinds count from 1
  std::map<Track, Timestamp> seen_;             // tracks located recently
  std::uint64_t left_out_ = 0;
};

}  // namespace rayloc
