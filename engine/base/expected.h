// Expected<T>: a value, or an Error that states the fault, its place and the remedy.
//
// Every fault caused by input is returned as an Error. Internal faults are RAYLOC_CHECK.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace rayloc {

// The kind of failure; the command line maps it to the exit status (INTERFACE 1).
enum class ErrorKind {
  kUsage,          // the call itself is wrong (exit 64)
  kBadInput,       // input data are invalid (exit 65)
  kUnavailable,    // a device, port or file cannot be opened (exit 69)
  kInternal,       // an internal fault (exit 70)
  kConfiguration,  // a configuration or site file is invalid (exit 78)
};

// `message` begins with the place ("site.toml:12:3: ...", "x.pcap: byte 1204: ...") where there is
// one, names the fault and what to write or do instead. No trailing newline.
struct Error {
  ErrorKind kind = ErrorKind::kBadInput;
  std::string message;
};

template <typename T>
using Expected = tl::expected<T, Error>;

inline tl::unexpected<Error> make_error(ErrorKind kind, std::string message) {
  return tl::make_unexpected(Error{kind, std::move(message)});
}
inline tl::unexpected<Error> bad_input(std::string message) {
  return make_error(ErrorKind::kBadInput, std::move(message));
}

// Returns the error of an Expected<T> from the enclosing function, or continues if it has a value.
//   auto site = load_site(folder);
//   RAYLOC_TRY(site);
//   RAYLOC_TRY(write_file(path, text));
#define RAYLOC_TRY(...)                                                      \
  do {                                                                       \
    if (const auto& rayloc_try_result = (__VA_ARGS__); !rayloc_try_result) { \
      return ::tl::make_unexpected(rayloc_try_result.error());               \
    }                                                                        \
  } while (false)

}  // namespace rayloc
