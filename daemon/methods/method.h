// Method: a localization method as one row of the registry (method_registry.h). The row contains
// everything that `rayloc` and `raylocd` use: names, help, checks and construction come from it.
// daemon/methods/README.md explains how to add one.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class DeviceMethod;
struct DeviceMethodInput;
class PersonMethod;
struct PersonMethodInput;
struct BaselineSetting;
struct Training;  // trained state of a method
struct TrainingInput;

// A setting of a method in addition to the common ones (MethodOptions).
struct MethodSetting {
  std::string_view key;
  std::string_view meaning;
};

struct Method {
  std::string_view name;            // as typed by people, and in quality.method of its estimates
  std::string_view summary;         // for --help, without a full stop
  std::string_view reference = {};  // the publication; empty: unpublished
  std::string_view domain;          // its requirements, as "a calibrated room"
  bool is_live = true;              // raylocd offers it; false: only recordings and studies do
  bool takes_start = false;         // it uses MethodOptions::start
  // It uses every frame of a burst; other methods use a selection.
  bool needs_every_frame = false;
  // It uses frames of other channels than the site's, by
  // CsiFrame::channel. For every other method the receiver rejects them.
  bool uses_every_channel = false;
  Duration lag{};  // largest lag of its tracks behind the end of the previous burst
  std::span<const MethodSetting> settings = {};
  std::span<const BaselineSetting> baseline_settings = {};  // by --baseline
  // Creates it for devices and people; null: not supported.
  Expected<std::unique_ptr<DeviceMethod>> (*create_device)(DeviceMethodInput) = nullptr;
  Expected<std::unique_ptr<PersonMethod>> (*create_person)(PersonMethodInput) = nullptr;
  // Trains on a survey; null: no training.
  Expected<std::shared_ptr<const Training>> (*train)(const TrainingInput&) = nullptr;
  bool needs_training = false;  // it cannot locate without training

  bool has_setting(std::string_view key) const;
};

}  // namespace rayloc
