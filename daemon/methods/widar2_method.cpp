// The row `widar2`: a walking person, from changes of the paths.
#include <memory>
#include <utility>

#include "daemon/methods/method.h"
#include "daemon/methods/walker_method.h"
#include "engine/baselines/widar2/widar2.h"

namespace rayloc {
namespace {

Expected<std::unique_ptr<PersonMethod>> create_person(PersonMethodInput input) {
  Widar2Options options = widar2_options(input.options.values);
  options.accuracy_confidence = input.options.accuracy_confidence;
  Widar2Link link{input.reference.mac, input.reference.transmitter.position, {}};
  for (const PersonLink& one : input.reference.links) {
    link.access_points.push_back(one.access_point);
  }
  auto made = Widar2::create(std::move(input.room), std::move(link), options);
  RAYLOC_TRY(made);
  return std::make_unique<WalkerMethod<Widar2>>(
      *std::move(made), input.first_number, "begun with the first motion");
}

}  // namespace

const Method& widar2_method() {
  static const Method kRow = {
      .name = "widar2",
      .summary = "a person who walks, by one link: length, its change and bearing of a path",
      .reference = "Widar2.0, ACM MobiSys 2018",
      .domain = "chain gains; one access point; 104 frames/s",
      .is_live = false,
      .needs_every_frame = true,
      .lag = Widar2::kMaxLag,
      .baseline_settings = widar2_settings(),
      .create_person = &create_person};
  return kRow;
}

}  // namespace rayloc
