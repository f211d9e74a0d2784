// Functions with which the rows of the table of keys store their values (config_schema.cpp and
// config_schema_inputs.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/live/config/config_schema.h"

namespace rayloc::config_rows {

using T = ConfigType;
using C = DaemonConfig;
using L = SiteConfig;
using S = SourceConfig;
using V = ConfigValue;

inline const std::string& text(const ConfigValue& value) { return std::get<std::string>(value); }
inline const std::vector<std::string>& texts(const ConfigValue& value) {
  return std::get<std::vector<std::string>>(value);
}
inline std::size_t count(const ConfigValue& value) {
  return static_cast<std::size_t>(std::get<std::int64_t>(value));
}
inline std::uint64_t mebibytes(const ConfigValue& value) {
  return std::uint64_t{count(value)} << 20U;
}
inline double number(const ConfigValue& value) { return std::get<double>(value); }

// Position of a choice among its names, which are in the order of the enumeration.
template <typename Enum, std::size_t kCount>
Enum chosen(const ConfigValue& value, const std::array<std::string_view, kCount>& names) {
  for (std::size_t i = 0; i < kCount; ++i) {
    if (names.at(i) == text(value)) {
      return static_cast<Enum>(i);
    }
  }
  return {};
}

// The methods of a daemon, and "none", which locates no target.
std::span<const std::string_view> engine_methods();
// The first method locates; the others are compared with it.
void store_methods(const ConfigValue& value,
                   const Method*& first,
                   std::vector<const Method*>& compared);

// Keys at the top of the file, of [site] and of [[source]].
std::span<const ConfigOption> input_options();

// Keys of [cluster].
std::span<const ConfigOption> cluster_options();

}  // namespace rayloc::config_rows
