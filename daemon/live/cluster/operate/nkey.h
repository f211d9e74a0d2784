// NKeys, by which NATS identifies clients: a seed, which only its owner may
// read, and the public key, which is listed in the configuration of the
// servers. Ed25519; the text format is that of github.com/nats-io/nkeys.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace rayloc {

// Returns a user seed, "SU...".
std::string make_nkey_seed();
// Returns "U..."; an Error where the text is no seed of a user.
Expected<std::string> nkey_of_seed(std::string_view seed);

// Returns the public key of the seed in that file, which must be private.
Expected<std::string> read_nkey(const std::filesystem::path& file);

}  // namespace rayloc
