// Files that hold a key or a token on their first line.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

struct KeyKind {
  const char* name;    // "token": for messages
  const char* advice;  // advice if it cannot be read
};

// Returns an Error if every user of this machine may use the file. Its group may: systemd passes
// credentials by an access list, which appears as group access.
Expected<void> check_private(const std::filesystem::path& file, const KeyKind& kind);

// The first line, without blanks at its end; kConfiguration if the file cannot be read. The caller
// checks the form of the key.
Expected<std::string> read_key_line(const std::filesystem::path& file, const KeyKind& kind);

// The same for a secret, whose file must be private.
Expected<std::string> read_secret(const std::filesystem::path& file, const KeyKind& kind);

// Creates the file, readable only by its owner; an existing file is never changed. kUnavailable if
// it exists or cannot be written.
Expected<void> write_secret(const std::filesystem::path& file, const std::string& secret);

}  // namespace rayloc
