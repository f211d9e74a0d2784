// "Did you mean ...?": finds the known name that a mistyped one most likely means.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace rayloc {

// The closest of `names`, or nothing when none is close: few typing errors away, or equal except
// for '_', '-' and case, or an abbreviation of exactly one ("halfwave" of "half_wave_dipole").
std::string_view closest_name(std::string_view word, std::span<const std::string_view> names);

// "; did you mean 'NAME'?", or "; there are: a, b, c" when none is close, or nothing.
std::string suggestion(std::string_view word, std::span<const std::string_view> names);
std::string suggestion(std::string_view word, std::span<const std::string> names);

// "a, b, c"
std::string list_of(std::span<const std::string_view> names);

}  // namespace rayloc
