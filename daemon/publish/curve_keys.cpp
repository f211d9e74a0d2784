#include "daemon/publish/curve_keys.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <zmq.h>

namespace rayloc {
namespace {

constexpr std::size_t kKeyCharacters = 40;
constexpr std::size_t kKeyBytes = 32;
constexpr const char* kAdvice = "make one with: rayloc keygen FILE";

Expected<std::string> read_key(const std::filesystem::path& file, const char* what) {
  std::ifstream in(file);
  if (!in) {
    return make_error(
        ErrorKind::kConfiguration,
        file.string() + ": " + what + " cannot be read: " + std::strerror(errno) + "; " + kAdvice);
  }
  std::string line;
  std::getline(in, line);
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) {
    line.pop_back();
  }
  if (!is_curve_key(line)) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": its first line is no " + what +
                          ", which is 40 characters (Z85); " + kAdvice);
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
  std::array<std::uint8_t, kKeyBytes> bytes{};
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
  struct stat status {};
  // Group may be allowed: systemd hands credentials over by an access list, which shows as that.
  if (stat(file.c_str(), &status) == 0 && (status.st_mode & S_IRWXO) != 0) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() +
                          ": everyone on this machine may use this secret key; take that away "
                          "(chmod 600), and make a new key if others were here");
  }
  Expected<std::string> secret = read_key(file, "secret key");
  if (!secret) {
    return tl::make_unexpected(secret.error());
  }
  std::string public_key = curve_public_key(*secret);
  return CurveKeyPair{std::move(public_key), std::move(*secret)};
}

Expected<std::string> read_curve_public(const std::filesystem::path& file) {
  return read_key(file, "public key");
}

Expected<void> write_curve_secret(const std::filesystem::path& file,
                                  const std::string& secret_key) {
  const auto refuse = [&](int number) {
    return make_error(ErrorKind::kUnavailable,
                      file.string() + ": cannot be made: " + std::strerror(number));
  };
  const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (fd < 0) {
    return refuse(errno);
  }
  const std::string line = secret_key + "\n";
  const bool written =
      write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size()) && fsync(fd) == 0;
  const int number = errno;
  close(fd);
  if (!written) {
    unlink(file.c_str());
    return refuse(number);
  }
  return {};
}

}  // namespace rayloc
