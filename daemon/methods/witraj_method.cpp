// The row `witraj`: a walking person, by steps from a known start.
#include <utility>

#include "daemon/methods/method.h"
#include "daemon/methods/walker_method.h"
#include "engine/baselines/witraj/witraj.h"

namespace rayloc {
namespace {

Expected<std::unique_ptr<PersonMethod>> create_person(PersonMethodInput input) {
  WitrajOptions options = witraj_options(input.options.values);
  options.accuracy_confidence = input.options.accuracy_confidence;
  WitrajLink link{input.reference.mac, input.reference.transmitter.position, {}};
  for (const PersonLink& one : input.reference.links) {
    link.access_points.push_back(one.access_point);
  }
  auto made = Witraj::create(std::move(input.room), std::move(link), input.options.start, options);
  RAYLOC_TRY(made);
  return std::make_unique<WalkerMethod<Witraj>>(
      *std::move(made), input.first_number, "begun at the start");
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
      .lag = Witraj::kMaxLag,
      .baseline_settings = witraj_settings(),
      .create_person = &create_person};
  return kRow;
}

}  // namespace rayloc
