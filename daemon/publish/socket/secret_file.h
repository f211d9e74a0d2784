// Files that hold a key or a token on their first line.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

struct KeyKind {
  const char* name;    // "token": for messages
  const char* advice;  // what to do where it cannot be read
};

// An Error where everyone on this machine may use the file. Its group may: systemd hands
// credentials over by an access list, which shows as that.
Expected<void> check_private(const std::filesystem::path& file, const KeyKind& kind);

// The first line, without blanks at its end; kConfiguration where the file cannot be read. What a
// key of that kind looks like is for the caller.
Expected<std::string> read_key_line(const std::filesystem::path& file, const KeyKind& kind);

// The same of a secret, whose file must be private.
Expected<std::string> read_secret(const std::filesystem::path& file, const KeyKind& kind);

// Makes the file, which only its owner may read; a file that exists is never touched. kUnavailable
// when it exists or cannot be written.
Expected<void> write_secret(const std::filesystem::path& file, const std::string& secret);

}  // namespace rayloc
