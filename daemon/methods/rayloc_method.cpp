// The row `rayloc`: the likelihood over the positions of the calibrated room, and tracks.
#include <array>
#include <utility>

#include "daemon/methods/device_method.h"
#include "daemon/methods/localizer_capabilities.h"
#include "daemon/methods/method.h"
#include "daemon/methods/person_method.h"
#include "daemon/methods/track_options.h"
#include "engine/likelihood/likelihood.h"
#include "engine/localize/localizer.h"
#include "engine/person/people.h"
#include "engine/person/person_localizer.h"

namespace rayloc {
namespace {

constexpr std::string_view kLikelihood = "likelihood";
constexpr std::string_view kPersonCell = "person_cell_m";

constexpr std::array kSettings = std::to_array<MethodSetting>({
    {kLikelihood, "quantity of a device's channel that is compared (likelihood_names())"},
    {kTracksSetting, "how a confirmed track follows a device: grid or cloud"},
    {kPersonCell, "cell of the grid on which people are searched for [m]"},
});

class RaylocTracks : public TrackCapability {
 public:
  RaylocTracks(std::shared_ptr<const Localizer> localizer,
               const LocalizerChains& chains,
               DeviceTrackerOptions options)
      : tracker_(std::move(localizer), std::move(options)), chains_(chains) {}

  // Bursts before a withdrawal are tracked before their information is discarded.
  std::vector<std::vector<DeviceUpdate>> track(std::span<const ReceivedBurst> bursts) override {
    std::vector<std::vector<DeviceUpdate>> updates;
    std::vector<DeviceBurst> together;
    const auto finish = [&] {
      for (std::vector<DeviceUpdate>& some : tracker_.receive(together)) {
        updates.push_back(std::move(some));
      }
      together.clear();
    };
    for (const ReceivedBurst& received : bursts) {
      if (received.withdrawals != withdrawals_) {
        finish();
        forget_what_was_wrong(received.withdrawals);
      }
      together.push_back(received.burst);
    }
    finish();
    return updates;
  }
  void advance(Timestamp now,
               std::vector<DeviceUpdate>& updates,
               const DeviceTracker::IsWaiting& is_waiting) override {
    forget_what_was_wrong(chains_.withdrawals());
    tracker_.advance(now, updates, is_waiting);
  }
  void restart(const std::string& reason, std::vector<DeviceUpdate>& updates) override {
    tracker_.restart(reason, updates);
  }
  bool has_track(const MacAddress& device) const override { return tracker_.has(device); }
  bool follows(const MacAddress& device) const override { return tracker_.follows(device); }
  Timestamp received_until(Timestamp now) const override { return tracker_.received_until(now); }
  TrackerCounters tracker_counters() const override { return tracker_.counters(); }

 private:
  // A track that used frames of wrong chains would continue from their wrong position.
  void forget_what_was_wrong(std::uint64_t withdrawals) {
    if (withdrawals != withdrawals_) {
      withdrawals_ = withdrawals;
      tracker_.forget_places();
    }
  }

  DeviceTracker tracker_;
  const LocalizerChains& chains_;
  std::uint64_t withdrawals_ = 0;
};

class RaylocDevices : public DeviceMethod {
 public:
  // Chains are learned with Gaussian likelihoods only.
  RaylocDevices(std::shared_ptr<const Localizer> localizer,
                std::set<MacAddress> listed,
                const TrackOptions& track)
      : localizer_(std::move(localizer)),
        chains_(localizer_),
        tracks_(localizer_,
                chains_,
                [&] {
                  DeviceTrackerOptions options;
                  options.always = std::move(listed);
                  options.track = track;
                  return options;
                }()),
        channel_(std::make_shared<const LocalizerChannel>(localizer_)),
        learns_(ChainLearner::learns_from(localizer_->options().likelihood)) {}

  const RoomModel& room() const override { return localizer_->room(); }
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t) const override {
    return localizer_->locate(frames, learns_ ? chains_.trust(frames).chain_fault : FrameFault());
  }

  TrackCapability* tracks() override { return &tracks_; }
  ChainCapability* chains() override { return learns_ ? &chains_ : nullptr; }
  std::shared_ptr<const ChannelCapability> channel() const override { return channel_; }

 private:
  std::shared_ptr<const Localizer> localizer_;
  LocalizerChains chains_;
  RaylocTracks tracks_;
  std::shared_ptr<const ChannelCapability> channel_;
  bool learns_;
};

class RaylocPeople : public PersonMethod {
 public:
  RaylocPeople(std::shared_ptr<const PersonLocalizer> localizer,
               const PersonTrackerOptions& tracker)
      : localizer_(std::move(localizer)), tracker_(localizer_, tracker) {}

  std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                       std::uint64_t) const override {
    return locate_people(*localizer_, frames);
  }

  void track(std::span<const CsiFrame> frames,
             std::optional<Timestamp> received_since,
             std::vector<PersonUpdate>& updates) override {
    tracker_.receive(frames, updates, received_since);
  }
  void advance(Timestamp now, std::vector<PersonUpdate>& updates) override {
    tracker_.advance(now, updates);
  }
  void restart(const std::string& reason, std::vector<PersonUpdate>& updates) override {
    tracker_.restart(reason, updates);
  }
  std::optional<std::uint64_t> track_number() const override { return tracker_.number(); }
  std::optional<Timestamp> last_moment() const override { return tracker_.last_moment(); }
  Timestamp seen_until(Timestamp now) const override { return tracker_.seen_until(now); }
  PersonTrackerCounters tracker_counters() const override { return tracker_.counters(); }

 private:
  std::shared_ptr<const PersonLocalizer> localizer_;
  PersonTracker tracker_;
};

Expected<std::unique_ptr<DeviceMethod>> create_device(DeviceMethodInput input) {
  LocalizerOptions options;
  options.accuracy_confidence = input.options.accuracy_confidence;
  options.path_grids = std::move(input.options.path_grids);
  if (const auto* name = find_value<std::string>(input.options.values, kLikelihood)) {
    options.likelihood = likelihood_of(*name);
  }
  auto made = Localizer::create(std::move(input.room), options);
  RAYLOC_TRY(made);
  return std::make_unique<RaylocDevices>(std::make_shared<const Localizer>(*std::move(made)),
                                         std::move(input.listed),
                                         track_options(input.options));
}

Expected<std::unique_ptr<PersonMethod>> create_person(PersonMethodInput input) {
  PersonLocalizerOptions options;
  options.accuracy_confidence = input.options.accuracy_confidence;
  if (const auto* cell = find_value<double>(input.options.values, kPersonCell)) {
    options.cell = *cell;
  }
  auto made = PersonLocalizer::create(std::move(input.room), std::move(input.reference), options);
  RAYLOC_TRY(made);
  PersonTrackerOptions tracker;
  tracker.is_exhaustive = input.options.is_exhaustive;
  tracker.first_number = input.first_number;
  tracker.number_step = input.number_step;
  tracker.numbered_before = input.numbered_before;
  tracker.last_moment = input.last_moment;
  return std::make_unique<RaylocPeople>(std::make_shared<const PersonLocalizer>(*std::move(made)),
                                        tracker);
}

}  // namespace

const Method& rayloc_method() {
  static constexpr Method kRow = {.name = "rayloc",
                                  .summary = "how likely every place of the room is, and tracks",
                                  .domain = "a calibrated room",
                                  .settings = kSettings,
                                  .create_device = &create_device,
                                  .create_person = &create_person};
  return kRow;
}

}  // namespace rayloc
