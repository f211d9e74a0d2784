// Keys of CURVE, ZeroMQ's encryption and authentication (RFC 26): generation, storage in files,
// reading.
//
// A key is 40 characters (Z85) and the only text in the first line of its file. Z85 uses characters
// that shells interpret: keys are passed by file, not on a command line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace rayloc {

inline constexpr std::size_t kCurveKeyBytes = 32;

struct CurveKeyPair {
  std::string public_key;
  std::string secret_key;
};

// Generates keys from the system's entropy.
CurveKeyPair make_curve_keys();

// True for 40 characters of Z85, which encode 32 bytes.
bool is_curve_key(std::string_view text);

// The public half of a secret key. REQUIRES: is_curve_key(secret_key).
std::string curve_public_key(const std::string& secret_key);

// Reads the key pair from a secret key's file. kConfiguration if it cannot be read, holds no key,
// or if every user of the machine may read or change it.
Expected<CurveKeyPair> read_curve_secret(const std::filesystem::path& file);

Expected<std::string> read_curve_public(const std::filesystem::path& file);

// The keys that a client needs to connect to a server.
struct CurveClientKeys {
  std::string server_key;  // the server's public key
  CurveKeyPair own;
};

}  // namespace rayloc
