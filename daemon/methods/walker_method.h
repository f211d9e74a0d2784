// WalkerMethod: tracks a walking person, as a method for people. A single burst gives no position:
// locate() returns the reason, or nothing.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "daemon/methods/person_method.h"

namespace rayloc {

// Walker: has receive(frames, estimates), problem() and restart().
template <typename Walker>
class WalkerMethod : public PersonMethod {
 public:
  // `begun`: reason for the confirmation of the track, as text.
  WalkerMethod(Walker walker, std::uint64_t number, std::string begun)
      : walker_(std::move(walker)), number_(number), begun_(std::move(begun)) {}

  std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                       std::uint64_t) const override {
    if (walker_.problem().empty() || frames.empty()) {
      return {};
    }
    LocationEstimate estimate;
    estimate.reason = walker_.problem();
    estimate.capture_start = frames.front().time;
    estimate.capture_end = frames.back().time;
    estimate.time = estimate.capture_start + (estimate.capture_end - estimate.capture_start) / 2;
    return {std::move(estimate)};
  }

  void track(std::span<const CsiFrame> frames,
             std::optional<Timestamp>,
             std::vector<PersonUpdate>& updates) override {
    std::vector<LocationEstimate> places;
    walker_.receive(frames, places);
    for (LocationEstimate& place : places) {
      FilteredEstimate filtered;
      filtered.state = TrackState::kConfirmed;
      if (!is_begun_) {
        filtered.transition =
            TrackTransition{place.time, std::nullopt, TrackState::kConfirmed, begun_};
        is_begun_ = true;
      }
      filtered.location = std::move(place);
      updates.push_back({number_, std::move(filtered)});
    }
  }
  void restart(const std::string&, std::vector<PersonUpdate>&) override {
    walker_.restart();
    is_begun_ = false;
  }
  std::optional<std::uint64_t> track_number() const override { return number_; }

 private:
  Walker walker_;
  std::uint64_t number_;
  std::string begun_;
  bool is_begun_ = false;
};

}  // namespace rayloc
