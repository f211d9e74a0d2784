// The method `dummy`, for tests alone: it places every device in the middle of the room. No file of
// the product refers to it.
#include <utility>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method.h"

namespace rayloc {
namespace {

class MiddleOfTheRoom : public DeviceMethod {
 public:
  explicit MiddleOfTheRoom(std::shared_ptr<const RoomModel> room) : room_(std::move(room)) {}

  const RoomModel& room() const override { return *room_; }

  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t) const override {
    LocationEstimate estimate;
    estimate.position = 0.5 * (room_->bounds_min + room_->bounds_max);
    estimate.is_uncertainty_stated = false;
    estimate.frames_used = frames.size();
    estimate.capture_start = frames.front().time;
    estimate.capture_end = frames.back().time;
    estimate.time = estimate.capture_start + (estimate.capture_end - estimate.capture_start) / 2;
    return estimate;
  }

 private:
  std::shared_ptr<const RoomModel> room_;
};

Expected<std::unique_ptr<DeviceMethod>> create_device(DeviceMethodInput input) {
  return std::make_unique<MiddleOfTheRoom>(std::move(input.room));
}

}  // namespace

const Method& dummy_method() {
  static constexpr Method kRow = {.name = "dummy",
                                  .summary = "the middle of the room",
                                  .domain = "the bounds of a room",
                                  .create_device = &create_device};
  return kRow;
}

}  // namespace rayloc
