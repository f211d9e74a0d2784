// Method: a way to locate targets, as one row of the registry (method_registry.h). The row is all
// that `rayloc` and `raylocd` know of a method: names, help, checks and construction come from it.
// daemon/methods/README.md says how to add one.
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
struct Training;  // what a method has learned
struct TrainingInput;

// What a method can be told beyond what all can (MethodOptions).
struct MethodSetting {
  std::string_view key;
  std::string_view meaning;
};

struct Method {
  std::string_view name;            // as people write it, and in quality.method of what it states
  std::string_view summary;         // for --help, without a full stop
  std::string_view reference = {};  // who published it; empty: nobody
  std::string_view domain;          // what it needs, as "a calibrated room"
  bool is_live = true;              // raylocd offers it; without, only recordings and studies do
  bool takes_start = false;         // MethodOptions::start means something to it
  // Each frame of a burst tells something; others are told by some of many.
  bool needs_every_frame = false;
  // It uses frames of other channels than the site's, by CsiFrame::channel. For every other method
  // the receiver rejects them.
  bool uses_every_channel = false;
  Duration lag{};  // by which its tracks may be behind the end of the burst before
  std::span<const MethodSetting> settings = {};
  std::span<const BaselineSetting> baseline_settings = {};  // by --baseline
  // How it locates devices and people; null: it does not.
  Expected<std::unique_ptr<DeviceMethod>> (*create_device)(DeviceMethodInput) = nullptr;
  Expected<std::unique_ptr<PersonMethod>> (*create_person)(PersonMethodInput) = nullptr;
  // Learns from a survey; null: there is nothing to learn.
  Expected<std::shared_ptr<const Training>> (*train)(const TrainingInput&) = nullptr;
  bool needs_training = false;  // it cannot locate before

  bool has_setting(std::string_view key) const;
};

}  // namespace rayloc
