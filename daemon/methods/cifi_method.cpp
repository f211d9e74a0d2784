// The row `cifi`: images of phase differences, compared by a
// network with those of surveyed places. It has no tracks.
#include <memory>
#include <utility>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method.h"
#include "engine/baselines/cifi/cifi.h"

namespace rayloc {
namespace {

class CifiDevices : public DeviceMethod {
 public:
  explicit CifiDevices(PlaceClassifier classifier)
      : classifier_(std::make_unique<PlaceClassifier>(std::move(classifier))) {}

  const RoomModel& room() const override { return classifier_->room(); }
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat) const override {
    return classifier_->locate(frames, repeat);
  }

 private:
  std::unique_ptr<PlaceClassifier> classifier_;
};

Expected<std::unique_ptr<DeviceMethod>> create_device(DeviceMethodInput input) {
  auto made = make_cifi(std::move(input.room),
                        input.options.values,
                        input.options.seed,
                        input.options.accuracy_confidence,
                        std::move(input.training));
  RAYLOC_TRY(made);
  return std::make_unique<CifiDevices>(*std::move(made));
}

}  // namespace

const Method& cifi_method() {
  static const Method kRow = {.name = "cifi",
                              .summary = "a network trained on images of phases at known places",
                              .reference = "CiFi, IEEE ICC 2017",
                              .domain = "chain gains; surveyed places",
                              .baseline_settings = cifi_settings(),
                              .create_device = &create_device,
                              .train = &train_cifi,
                              .needs_training = true};
  return kRow;
}

}  // namespace rayloc
