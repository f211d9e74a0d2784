// The row `witraj`: a person who walks, by steps from a known start.
#include <utility>

#include "daemon/methods/method.h"
#include "daemon/methods/person_method.h"
#include "engine/baselines/witraj/witraj.h"

namespace rayloc {
namespace {

class WitrajPeople : public PersonMethod {
 public:
  WitrajPeople(Witraj witraj, std::uint64_t number) : witraj_(std::move(witraj)), number_(number) {}

  // Steps alone tell a place: a burst of its own says why there is none, or nothing.
  std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                       std::uint64_t) const override {
    if (witraj_.problem().empty() || frames.empty()) {
      return {};
    }
    LocationEstimate estimate;
    estimate.reason = witraj_.problem();
    estimate.capture_start = frames.front().time;
    estimate.capture_end = frames.back().time;
    estimate.time = estimate.capture_start + (estimate.capture_end - estimate.capture_start) / 2;
    return {std::move(estimate)};
  }

  void track(std::span<const CsiFrame> frames,
             std::optional<Timestamp>,
             std::vector<PersonUpdate>& updates) override {
    std::vector<LocationEstimate> places;
    witraj_.hear(frames, places);
    for (LocationEstimate& place : places) {
      FilteredEstimate filtered;
      filtered.state = TrackState::kConfirmed;
      if (!is_begun_) {
        filtered.transition =
            TrackTransition{place.time, std::nullopt, TrackState::kConfirmed, "begun at the start"};
        is_begun_ = true;
      }
      filtered.location = std::move(place);
      updates.push_back({number_, std::move(filtered)});
    }
  }
  void restart(const std::string&, std::vector<PersonUpdate>&) override {
    witraj_.restart();
    is_begun_ = false;
  }
  std::optional<std::uint64_t> track_number() const override { return number_; }

 private:
  Witraj witraj_;
  std::uint64_t number_;
  bool is_begun_ = false;
};

Expected<std::unique_ptr<PersonMethod>> create_person(PersonMethodInput input) {
  WitrajOptions options = witraj_options(input.options.values);
  options.accuracy_confidence = input.options.accuracy_confidence;
  WitrajLink link{input.reference.mac, input.reference.transmitter.position, {}};
  for (const PersonLink& one : input.reference.links) {
    link.access_points.push_back(one.access_point);
  }
  auto made = Witraj::create(std::move(input.room), std::move(link), input.options.start, options);
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  return std::make_unique<WitrajPeople>(*std::move(made), input.first_number);
}

}  // namespace

const Method& witraj_method() {
  static const Method kRow = {
      .name = "witraj",
      .summary = "a person who walks, by steps from a known start (--start)",
      .reference = "WiTraj, IEEE TMC 2023",
      .domain = "chain gains, 2 access points (3 to drop the worst), 182 frames/s",
      .is_live = false,
      .takes_start = true,
      .needs_every_frame = true,
      .lag = Witraj::kMostLag,
      .baseline_settings = witraj_settings(),
      .create_person = &create_person};
  return kRow;
}

}  // namespace rayloc
