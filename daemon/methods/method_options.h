// MethodOptions: options for the construction of a method. All methods get the same options; each
// uses those of `values` that its row lists.
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

// By MethodSetting::key. A missing key has the method's default.
using MethodValues = std::map<std::string, std::variant<double, std::string>, std::less<>>;

struct MethodOptions {
  double accuracy_confidence = 0.95;  // confidence of the stated accuracy
  std::uint64_t seed = 1;             // for random draws of the method
  // Every burst is compared with the whole room: the reference for the search of candidates.
  bool is_exhaustive = false;
  std::shared_ptr<PathGridStore> path_grids;  // cache of traced rooms; null: no cache
  std::optional<Vec3d> start;  // start of a method that takes one (Method::takes_start)
  MethodValues values;
};

// Null if the key has no value of that type.
template <typename T>
const T* find_value(const MethodValues& values, std::string_view key) {
  const auto found = values.find(key);
  return found == values.end() ? nullptr : std::get_if<T>(&found->second);
}

}  // namespace rayloc
