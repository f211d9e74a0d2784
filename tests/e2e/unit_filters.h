// The filters of system calls of the units in deploy/units, for a process of a test.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rayloc::e2e {

// The text of deploy/units/NAME.
std::string unit_text(const std::string& name);

// The calls that its lines SystemCallFilter= allow. Throws when there are none.
std::set<std::string> allowed_calls(const std::string& unit);

// For ProcessSetting::wrapper: lets only these calls through, and sockets of these address families
// (numbers, "1,2,10"); the list is kept in `folder`. Nothing in the build of a sanitizer, whose own
// calls are not those of a unit.
std::vector<std::string> filters(const std::filesystem::path& folder,
                                 const std::set<std::string>& calls,
                                 const std::string& families);

// True if this build has filters.
bool has_filters();

}  // namespace rayloc::e2e
