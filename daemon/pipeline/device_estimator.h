// DeviceEstimator: locates the transmitters that the site wants located (device-based): those
// listed with role "device" and, unless the site says otherwise, those not listed at all. Each
// burst gives a snapshot, and filtered estimates of the moments within it.
//
// Bursts of fixed transmitters give no location here; they tell whether the calibration still holds
// (CalibrationMonitor), and what they tell stands in the warnings of every location.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "daemon/publish/location_message.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/calibrate/calibration_monitor.h"
#include "engine/localize/localizer.h"
#include "engine/localize/paper_localizer.h"
#include "engine/track/device_tracker.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc {

enum class LocationMethod : std::uint8_t { kRayloc, kPaper };

class DeviceEstimator : public Estimator {
 public:
  struct Options {
    LocationMethod method = LocationMethod::kRayloc;
    LocalizerOptions localizer;                           // of kRayloc
    DeviceTrackerOptions tracker;                         // of kRayloc
    PaperLocalizerOptions paper;                          // of kPaper
    Duration valid_for = std::chrono::milliseconds(450);  // until a next burst is overdue
  };

  // Reads the scene and prepares the room: seconds. Devices of different height or antenna need
  // a room each.
  static Expected<std::unique_ptr<DeviceEstimator>> create(const Site& site,
                                                           const Options& options);

  void estimate(const Burst& burst, std::vector<v1::Location>& out) override;

  void advance(Timestamp time, std::vector<v1::Location>& out) override;

  // What holds now. Thread safety: may be called from any thread.
  std::vector<CalibrationWarning> calibration_warnings() const;

  const RoomModel& room() const { return rooms_.front().room(); }

 private:
  struct Room {
    DeviceModel device;
    std::variant<std::shared_ptr<const Localizer>, std::shared_ptr<const PaperLocalizer>> localizer;
    std::optional<DeviceTracker> tracker;  // the paper's method has none

    const RoomModel& room() const;
    LocationEstimate locate(std::span<const CsiFrame> frames) const;
  };

  DeviceEstimator(Site site, Options options)
      : site_(std::move(site)), options_(std::move(options)) {}
  Expected<Room> prepare(std::shared_ptr<const RoomModel> room) const;
  void check_calibration(const SiteTransmitter& fixed, const Burst& burst);
  DeviceModel device_of(const SiteTransmitter* stated) const;
  LocationContext context_of(const MacAddress& device, const Room& room) const;
  void append(const std::vector<DeviceUpdate>& updates,
              const Room& room,
              std::vector<v1::Location>& out) const;

  const Site site_;
  const Options options_;
  std::vector<Room> rooms_;                      // the first is that of unlisted devices
  std::unique_ptr<CalibrationMonitor> monitor_;  // the estimation thread's
  mutable std::mutex mutex_;
  std::vector<CalibrationWarning> warnings_;  // guarded by mutex_
};

}  // namespace rayloc
