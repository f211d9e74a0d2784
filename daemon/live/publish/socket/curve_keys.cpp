#include "daemon/live/publish/socket/curve_keys.h"

#include <array>
#include <cstdint>
#include <stdexcept>

#include <zmq.h>

#include "daemon/base/secret_file.h"

namespace rayloc {
namespace {

constexpr std::size_t kKeyCharacters = 40;
constexpr const char* kKeyAdvice = "make one with: rayloc keygen FILE";
constexpr KeyKind kSecretKey = {"secret key", kKeyAdvice};
constexpr KeyKind kPublicKey = {"public key", kKeyAdvice};

Expected<std::string> checked_key(const std::filesystem::path& file,
                                  const KeyKind& kind,
                                  std::string line) {
  if (!is_curve_key(line)) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": its first line is no " + kind.name +
                          ", which is 40 characters (Z85); " + kKeyAdvice);
  }
  return line;
}

}  // namespace

CurveKeyPair make_curve_keys() {
  std::array<char, kKeyCharacters + 1> public_key{};
  std::array<char, kKeyCharacters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    throw std::runtime_error("libzmq was built without CURVE");
  }
  return {public_key.data(), secret_key.data()};
}

bool is_curve_key(std::string_view text) {
  std::array<std::uint8_t, kCurveKeyBytes> bytes{};
  return text.size() == kKeyCharacters &&
         zmq_z85_decode(bytes.data(), std::string(text).c_str()) != nullptr;
}

std::string curve_public_key(const std::string& secret_key) {
  std::array<char, kKeyCharacters + 1> public_key{};
  if (zmq_curve_public(public_key.data(), secret_key.c_str()) != 0) {
    throw std::runtime_error("libzmq was built without CURVE");
  }
  return public_key.data();
}

Expected<CurveKeyPair> read_curve_secret(const std::filesystem::path& file) {
  Expected<std::string> line = read_secret(file, kSecretKey);
  Expected<std::string> secret = line ? checked_key(file, kSecretKey, *line) : std::move(line);
  RAYLOC_TRY(secret);
  std::string public_key = curve_public_key(*secret);
  return CurveKeyPair{std::move(public_key), std::move(*secret)};
}

Expected<std::string> read_curve_public(const std::filesystem::path& file) {
  const Expected<std::string> line = read_key_line(file, kPublicKey);
  return line ? checked_key(file, kPublicKey, *line) : line;
}

}  // namespace rayloc
