// The row `paper`: the published method, unmodified (METHODS A4). It has no tracks.
#include <utility>
#include <vector>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method.h"
#include "daemon/methods/person_method.h"
#include "engine/paper/localizer.h"
#include "engine/paper/person_localizer.h"
#include "engine/paper/settings.h"

namespace rayloc {
namespace {

constexpr std::string_view kMultiStart = "multi_start";

std::span<const MethodSetting> settings() {
  static const std::vector<MethodSetting> kAll = [] {
    std::vector<MethodSetting> all = {{kMultiStart, "random starts; the least loss wins"}};
    for (const paper::Setting& setting : paper::settings()) {
      all.push_back({setting.key, setting.meaning});
    }
    return all;
  }();
  return kAll;
}

// `defaults`: for the kind of target.
paper::LocalizerOptions apply(const MethodOptions& options, paper::LocalizerOptions defaults) {
  defaults.seed = options.seed;
  defaults.start = options.start;
  if (const auto* starts = find_value<double>(options.values, kMultiStart)) {
    defaults.starts = static_cast<std::size_t>(*starts);
  }
  for (const paper::Setting& setting : paper::settings()) {
    if (const auto* value = find_value<double>(options.values, setting.key)) {
      setting.set(defaults, *value);
    }
  }
  return defaults;
}

class PaperDevices : public DeviceMethod {
 public:
  PaperDevices(paper::Localizer localizer, std::uint64_t seed)
      : localizer_(std::move(localizer)), seed_(seed) {}

  const RoomModel& room() const override { return localizer_.room(); }
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat) const override {
    return localizer_.locate(frames, seed_ + repeat);
  }

 private:
  paper::Localizer localizer_;
  std::uint64_t seed_;
};

class PaperPeople : public PersonMethod {
 public:
  PaperPeople(paper::PersonLocalizer localizer, std::uint64_t seed)
      : localizer_(std::move(localizer)), seed_(seed) {}

  std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                       std::uint64_t repeat) const override {
    return {localizer_.locate(frames, seed_ + repeat)};
  }

 private:
  paper::PersonLocalizer localizer_;
  std::uint64_t seed_;
};

Expected<std::unique_ptr<DeviceMethod>> create_device(DeviceMethodInput input) {
  auto made = paper::Localizer::create(std::move(input.room), apply(input.options, {}));
  RAYLOC_TRY(made);
  return std::make_unique<PaperDevices>(*std::move(made), input.options.seed);
}

Expected<std::unique_ptr<PersonMethod>> create_person(PersonMethodInput input) {
  auto made = paper::PersonLocalizer::create(
      std::move(input.room), input.reference, apply(input.options, paper::person_options()));
  RAYLOC_TRY(made);
  return std::make_unique<PaperPeople>(*std::move(made), input.options.seed);
}

}  // namespace

const Method& paper_method() {
  static const Method kRow = {
      .name = "paper",
      .summary = "the published method as it is: one place by descent of a loss, no tracks",
      .reference = "arXiv 2501.17881",
      .domain = "a calibrated room",
      .is_live = false,
      .takes_start = true,
      .settings = settings(),
      .create_device = &create_device,
      .create_person = &create_person};
  return kRow;
}

}  // namespace rayloc
