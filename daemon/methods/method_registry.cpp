#include "daemon/methods/method_registry.h"

#include <algorithm>
#include <vector>

#include "engine/baselines/settings.h"

namespace rayloc {

bool Method::has_setting(std::string_view key) const {
  return std::any_of(settings.begin(),
                     settings.end(),
                     [&](const MethodSetting& setting) { return setting.key == key; }) ||
         std::any_of(baseline_settings.begin(), baseline_settings.end(), [&](const auto& setting) {
           return setting.key == key;
         });
}

std::span<const Method* const> methods() { return method_table(); }

const Method& default_method() { return *methods().front(); }

const Method* find_method(std::string_view name) {
  const auto all = methods();
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const Method* method) { return method->name == name; });
  return found == all.end() ? nullptr : *found;
}

std::span<const std::string_view> method_names() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const Method* method : methods()) {
      names.push_back(method->name);
    }
    return names;
  }();
  return kNames;
}

std::string methods_help() {
  std::string help;
  for (const Method* method : methods()) {
    const bool devices = method->create_device != nullptr;
    const bool people = method->create_person != nullptr;
    help += (help.empty() ? "" : "\n") + std::string(method->name) + ": " +
            std::string(method->summary) +
            (devices && people ? "; devices and people"
             : devices         ? "; devices"
                               : "; people") +
            "; needs " + std::string(method->domain);
    if (method->train != nullptr) {
      help += method->needs_training ? " and `rayloc train`" : ", better with `rayloc train`";
    }
    if (!method->reference.empty()) {
      help += "; " + std::string(method->reference);
    }
  }
  return help;
}

}  // namespace rayloc
