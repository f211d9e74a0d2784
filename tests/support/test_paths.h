// Paths of the checkout and of the build for a test program. No path is compiled in, so that a
// compiler cache serves every checkout. Both are found from the program's own location: the nearest
// folder above it that holds a CMakeCache.txt is the build, which names its source tree.
#pragma once

#include <string>
#include <string_view>

namespace rayloc::test {

// The checkout's root followed by `path`, for example "/deploy/experiments".
// Throws std::runtime_error if the program is not in a build tree.
std::string source_path(std::string_view path = {});

// tests/data of the checkout followed by `path`, for example "/sites/meeting_room";
// RAYLOC_TEST_DATA replaces the folder.
std::string data_path(std::string_view path = {});

// The program `name` of this build; RAYLOC_BIN replaces the folder.
std::string program_path(std::string_view name);

}  // namespace rayloc::test
