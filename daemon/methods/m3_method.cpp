// The row `m3`: the direct path and its reflections at known walls. It has no tracks.
#include <utility>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method.h"
#include "engine/baselines/m3/m3.h"

namespace rayloc {
namespace {

class M3Devices : public DeviceMethod {
 public:
  explicit M3Devices(M3 m3) : m3_(std::move(m3)) {}

  const RoomModel& room() const override { return m3_.room(); }
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t) const override {
    return m3_.locate(frames);
  }

 private:
  M3 m3_;
};

Expected<std::unique_ptr<DeviceMethod>> create_device(DeviceMethodInput input) {
  M3Options options = m3_options(input.options.values);
  options.accuracy_confidence = input.options.accuracy_confidence;
  auto made = M3::create(std::move(input.room), options);
  RAYLOC_TRY(made);
  return std::make_unique<M3Devices>(*std::move(made));
}

}  // namespace

const Method& m3_method() {
  static const Method kRow = {
      .name = "m3",
      .summary = "the direct path and its reflections at walls that are known",
      .reference = "M3, IEEE TMC 2021",
      .domain = "chain gains; a plan with walls; a device that hops over channels to be itself",
      .uses_every_channel = true,
      .baseline_settings = m3_settings(),
      .create_device = &create_device};
  return kRow;
}

}  // namespace rayloc
