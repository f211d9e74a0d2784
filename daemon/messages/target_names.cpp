#include "daemon/messages/target_names.h"

#include <sodium.h>

#include <stdexcept>

#include "daemon/base/secret_file.h"

namespace rayloc {
namespace {

constexpr std::size_t kHashBytes = 16;
constexpr std::size_t kShortestKey = 32;
// Sources that are recordings may be in different periods for a while.
constexpr std::size_t kKeptPeriods = 8;

using Digest = std::array<std::uint8_t, crypto_auth_hmacsha256_BYTES>;

Digest hmac(const std::uint8_t* key, std::size_t key_size, const void* text, std::size_t size) {
  crypto_auth_hmacsha256_state state;
  Digest digest{};
  crypto_auth_hmacsha256_init(&state, key, key_size);
  crypto_auth_hmacsha256_update(&state, static_cast<const unsigned char*>(text), size);
  crypto_auth_hmacsha256_final(&state, digest.data());
  return digest;
}

}  // namespace

TargetNames::Key TargetNames::key_of(std::int64_t period) {
  if (!options_.key.empty()) {
    const std::string text = "rayloc target period " + std::to_string(period);
    return hmac(reinterpret_cast<const std::uint8_t*>(options_.key.data()),
                options_.key.size(),
                text.data(),
                text.size());
  }
  const std::lock_guard lock(mutex_);
  const auto [found, fresh] = keys_.try_emplace(period);
  if (fresh) {
    if (sodium_init() < 0) {
      throw std::runtime_error("libsodium cannot be initialised");
    }
    randombytes_buf(found->second.data(), found->second.size());
  }
  const Key key = found->second;
  while (keys_.size() > kKeptPeriods) {
    sodium_memzero(keys_.begin()->second.data(), keys_.begin()->second.size());
    keys_.erase(keys_.begin());
  }
  return key;
}

std::string TargetNames::text(const MacAddress& transmitter, Timestamp time) {
  if (!options_.hashed) {
    return to_string(transmitter);
  }
  const Duration since = time.time_since_epoch();
  const std::int64_t period =
      since / options_.period - (since % options_.period < Duration{} ? 1 : 0);
  const Key key = key_of(period);
  const Digest digest =
      hmac(key.data(), key.size(), transmitter.octets.data(), transmitter.octets.size());
  std::array<char, 2 * kHashBytes + 1> hex{};
  sodium_bin2hex(hex.data(), hex.size(), digest.data(), kHashBytes);
  return hex.data();
}

Expected<std::string> TargetNames::read_key(const std::filesystem::path& file) {
  Expected<std::string> key = read_secret(
      file, {"key", "systemd passes a file of root to the daemon (drop-in privacy-key.conf)"});
  if (key && key->size() < kShortestKey) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() +
                          ": no key: its first line must have 32 characters or more; write one "
                          "with: (umask 077; openssl rand -hex 32 >" +
                          file.string() + ")");
  }
  return key;
}

}  // namespace rayloc
