#include "tests/support/public_captures.h"

#include <sodium.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "tests/support/test_paths.h"

namespace rayloc::test {
namespace {

constexpr std::size_t kHexDigits = std::size_t{2} * crypto_hash_sha256_BYTES;

std::string sha256_of(const std::string& path) {
  const std::vector<std::byte> bytes = read_bytes(path);
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  crypto_hash_sha256(
      hash.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  std::array<char, kHexDigits + 1> text{};
  return sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
}

// The SHA-256 that the README states in the row of `name`: | `NAME` | HASH | ….
std::string stated_sha256(const std::string& name) {
  std::ifstream readme(data_path("/captures/README.md"));
  const std::string row = "| `" + name + "` | ";
  for (std::string line; std::getline(readme, line);) {
    if (line.rfind(row, 0) == 0) {
      return line.substr(row.size(), kHexDigits);
    }
  }
  throw std::runtime_error("tests/data/captures/README.md has no row of " + name);
}

}  // namespace

std::optional<std::string> public_captures() {
  const char* stated = std::getenv("RAYLOC_PUBLIC_CAPTURES");
  std::string folder = stated != nullptr ? stated : source_path("/../shared/captures");
  return std::filesystem::is_directory(folder) ? std::optional(std::move(folder)) : std::nullopt;
}

std::string public_capture(const std::string& name) {
  std::string path = public_captures().value() + "/" + name;
  if (sha256_of(path) != stated_sha256(name)) {
    throw std::runtime_error(path +
                             ": not the file whose hash tests/data/captures/README.md states");
  }
  return path;
}

Recording read_public_capture(const std::string& name) {
  return read_recording(public_capture(name));
}

}  // namespace rayloc::test
