// MethodOptions: what a method is told when it is made. All methods are told the same; of `values`
// each takes those that its row lists.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "engine/base/vec3.h"

namespace rayloc {

class PathGridStore;

// By MethodSetting::key. A key that is not there has the method's default.
using MethodValues = std::map<std::string, std::variant<double, std::string>, std::less<>>;

struct MethodOptions {
  double accuracy_confidence = 0.95;  // of what is stated as accuracy
  std::uint64_t seed = 1;             // of what the method draws
  // Every burst is compared with the whole room: the reference of looking where a device may be.
  bool is_exhaustive = false;
  std::shared_ptr<PathGridStore> path_grids;  // keeps traced rooms; null: nothing is kept
  std::optional<Vec3d> start;  // where a method that takes one (Method::takes_start) begins
  MethodValues values;
};

// Null where the key has no value of that type.
template <typename T>
const T* find_value(const MethodValues& values, std::string_view key) {
  const auto found = values.find(key);
  return found == values.end() ? nullptr : std::get_if<T>(&found->second);
}

}  // namespace rayloc
