// NKeys, by which NATS knows who connects: a seed, which only its owner may read, and the public
// key, which stands in the configuration of the servers. Ed25519; the text is that of
// github.com/nats-io/nkeys.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace rayloc {

// "SU...", of a user.
std::string make_nkey_seed();
// "U..."; an Error where that is no seed of a user.
Expected<std::string> nkey_of_seed(std::string_view seed);

// The public key of the seed in that file, which must be private.
Expected<std::string> read_nkey(const std::filesystem::path& file);

}  // namespace rayloc
