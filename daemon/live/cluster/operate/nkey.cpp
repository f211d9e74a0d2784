#include "daemon/live/cluster/operate/nkey.h"

#include <sodium.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "daemon/base/secret_file.h"

namespace rayloc {
namespace {

// Bytes that encode to the first characters 'S' and 'U'.
constexpr std::uint8_t kSeed = 18 << 3;
constexpr std::uint8_t kUser = 20 << 3;
constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZ234567";  // base32, no padding
constexpr std::size_t kCharacterBits = 5;
constexpr std::size_t kSeedHead = 2;  // bytes
constexpr std::size_t kCrcBytes = 2;
constexpr const char* kAdvice = "make one with: rayloc keygen --nkey FILE";

using Bytes = std::vector<std::uint8_t>;

// CRC-16 of XMODEM.
std::uint16_t crc_of(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t kPolynomial = 0x1021;
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= std::uint32_t{byte} << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ kPolynomial : crc << 1U;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

// Encodes with the checksum, as text.
std::string text_of(Bytes bytes) {
  const std::uint32_t crc = crc_of(bytes);
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8U));
  std::string text;
  std::uint32_t held = 0;
  std::size_t bits = 0;
  for (const std::uint8_t byte : bytes) {
    held = (held << 8U) | byte;
    for (bits += 8; bits >= kCharacterBits; bits -= kCharacterBits) {
      text += kAlphabet[(held >> (bits - kCharacterBits)) & 0x1FU];
    }
  }
  if (bits > 0) {
    text += kAlphabet[(held << (kCharacterBits - bits)) & 0x1FU];
  }
  return text;
}

// Decodes without the checksum; nothing where the checksum is wrong.
std::optional<Bytes> bytes_of(std::string_view text) {
  Bytes bytes;
  std::uint32_t held = 0;
  std::size_t bits = 0;
  for (const char c : text) {
    const std::size_t value = kAlphabet.find(c);
    if (value == std::string_view::npos) {
      return std::nullopt;
    }
    held = (held << kCharacterBits) | static_cast<std::uint32_t>(value);
    bits += kCharacterBits;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::uint8_t>((held >> bits) & 0xFFU));
    }
  }
  if (bytes.size() < kCrcBytes) {
    return std::nullopt;
  }
  const std::uint32_t stated =
      bytes[bytes.size() - 2] | (std::uint32_t{bytes[bytes.size() - 1]} << 8U);
  bytes.resize(bytes.size() - kCrcBytes);
  return stated == crc_of(bytes) ? std::optional<Bytes>(std::move(bytes)) : std::nullopt;
}

void begin_sodium() {
  if (sodium_init() < 0) {
    throw std::runtime_error("libsodium cannot be initialised");
  }
}

}  // namespace

std::string make_nkey_seed() {
  begin_sodium();
  Bytes bytes(kSeedHead + crypto_sign_SEEDBYTES);
  bytes[0] = kSeed | (kUser >> 5U);
  bytes[1] = static_cast<std::uint8_t>((kUser & 0x1FU) << 3U);
  randombytes_buf(bytes.data() + kSeedHead, crypto_sign_SEEDBYTES);
  std::string text = text_of(bytes);
  sodium_memzero(bytes.data(), bytes.size());
  return text;
}

Expected<std::string> nkey_of_seed(std::string_view seed) {
  begin_sodium();
  std::optional<Bytes> bytes = bytes_of(seed);
  if (!bytes || bytes->size() != kSeedHead + crypto_sign_SEEDBYTES || seed.substr(0, 2) != "SU") {
    return make_error(ErrorKind::kConfiguration,
                      std::string("no seed of a user of NATS, which begins with SU; ") + kAdvice);
  }
  std::array<std::uint8_t, crypto_sign_PUBLICKEYBYTES> open{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret{};
  crypto_sign_seed_keypair(open.data(), secret.data(), bytes->data() + kSeedHead);
  sodium_memzero(secret.data(), secret.size());
  sodium_memzero(bytes->data(), bytes->size());
  Bytes named = {kUser};
  named.insert(named.end(), open.begin(), open.end());
  return text_of(std::move(named));
}

Expected<std::string> read_nkey(const std::filesystem::path& file) {
  Expected<std::string> seed = read_secret(file, {"seed of an NKey", kAdvice});
  if (!seed) {
    return seed;
  }
  Expected<std::string> key = nkey_of_seed(*seed);
  return key ? key : make_error(key.error().kind, file.string() + ": " + key.error().message);
}

}  // namespace rayloc
