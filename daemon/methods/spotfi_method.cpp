// The row `spotfi`: bearings of direct paths, and received powers. It has no tracks.
#include <utility>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method.h"
#include "engine/baselines/spotfi/spotfi.h"

namespace rayloc {
namespace {

class SpotfiDevices : public DeviceMethod {
 public:
  explicit SpotfiDevices(Spotfi spotfi) : spotfi_(std::move(spotfi)) {}

  const RoomModel& room() const override { return spotfi_.room(); }
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat) const override {
    return spotfi_.locate(frames, repeat);
  }

 private:
  Spotfi spotfi_;
};

Expected<std::unique_ptr<DeviceMethod>> create_device(DeviceMethodInput input) {
  SpotfiOptions options = spotfi_options(input.options.values);
  options.accuracy_confidence = input.options.accuracy_confidence;
  options.seed = input.options.seed;
  auto made = Spotfi::create(std::move(input.room), options, std::move(input.training));
  RAYLOC_TRY(made);
  return std::make_unique<SpotfiDevices>(*std::move(made));
}

}  // namespace

const Method& spotfi_method() {
  static const Method kRow = {
      .name = "spotfi",
      .summary = "bearings of direct paths, and levels where there is one",
      .reference = "SpotFi, SIGCOMM 2015",
      .domain = "chain gains; two access points, or one and a learned level",
      .baseline_settings = spotfi_settings(),
      .create_device = &create_device,
      .train = &train_spotfi};
  return kRow;
}

}  // namespace rayloc
