#include "daemon/site/model/path_grid_files.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/content_hash.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPathGridMagic = "RLPATHGR";
constexpr std::size_t kPathGridHeader = 24;
constexpr std::string_view kExtension = ".pathgrid";
constexpr std::string_view kUnfinished = ".unfinished";
// A program that ended while writing leaves its file behind.
constexpr auto kAbandonedAfter = std::chrono::hours(1);

void add_number(std::string& text, std::uint64_t value) {
  for (unsigned shift = 0; shift < 64; shift += 8) {
    text += static_cast<char>(static_cast<unsigned char>(value >> shift));
  }
}

std::uint64_t number_at(std::string_view text, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t i = 8; i-- > 0;) {
    value = value << 8U | static_cast<unsigned char>(text[offset + i]);
  }
  return value;
}

std::string header_of(std::string_view bytes) {
  ContentHash hash;
  hash.add(bytes);
  std::string header(kPathGridMagic);
  add_number(header, bytes.size());
  add_number(header, hash.value());
  return header;
}

// The whole file; empty if it cannot be read.
std::optional<std::string> read_whole(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : -1;
  if (size < 0) {
    return std::nullopt;
  }
  std::string text(static_cast<std::size_t>(size), '\0');
  stream.seekg(0);
  if (!stream.read(text.data(), size)) {
    return std::nullopt;
  }
  return text;
}

// Describes the damage of a file; empty if the file is whole.
std::string fault_of(std::string_view text) {
  if (text.size() < kPathGridHeader || text.substr(0, kPathGridMagic.size()) != kPathGridMagic) {
    return "is no path grid";
  }
  if (number_at(text, 8) != text.size() - kPathGridHeader) {
    return "is cut off";
  }
  return text.substr(0, kPathGridHeader) == header_of(text.substr(kPathGridHeader)) ? ""
                                                                                    : "is damaged";
}

struct Kept {
  fs::file_time_type used;
  fs::path file;
  std::uint64_t bytes = 0;
};

}  // namespace

fs::path PathGridFiles::file_of(const std::string& key) const {
  return options_.directory / (key + std::string(kExtension));
}

void PathGridFiles::report(const fs::path& file, const std::string& what) const {
  if (options_.log) {
    options_.log(file.string() + ": " + what);
  }
}

std::optional<std::string> PathGridFiles::load(const std::string& key) {
  const fs::path file = file_of(key);
  std::error_code failed;
  if (!fs::exists(file, failed)) {
    return std::nullopt;
  }
  std::optional<std::string> text = read_whole(file);
  const std::string fault = text ? fault_of(*text) : "cannot be read";
  if (!fault.empty()) {
    report(file, fault + "; made anew");
    return std::nullopt;
  }
  fs::last_write_time(file, fs::file_time_type::clock::now(), failed);  // marks the file as used
  text->erase(0, kPathGridHeader);
  return text;
}

void PathGridFiles::refuse(const std::string& key) {
  report(file_of(key), "is not what this program would make; made anew");
}

bool PathGridFiles::write(const fs::path& file, std::string_view bytes) const {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << header_of(bytes);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  return !stream.fail();
}

void PathGridFiles::save(const std::string& key, std::string_view bytes) {
  if (bytes.size() + kPathGridHeader > options_.most_bytes) {
    report(file_of(key), "not kept: larger than all path grids together may be");
    return;
  }
  std::error_code failed;
  fs::create_directories(options_.directory, failed);
  const fs::path file = file_of(key);
  fs::path unfinished = file;
  unfinished += "." + std::to_string(::getpid()) + std::string(kUnfinished);
  if (!write(unfinished, bytes)) {
    report(file, "not kept: cannot be written");
    fs::remove(unfinished, failed);
    return;
  }
  fs::rename(unfinished, file, failed);
  if (failed) {
    report(file, "not kept: " + failed.message());
    fs::remove(unfinished, failed);
    return;
  }
  drop_oldest(file);
}

// Removes files until the rest is within the limit. `kept` stays, whatever its time.
void PathGridFiles::drop_oldest(const fs::path& kept) const {
  std::error_code failed;
  std::vector<Kept> files;
  std::uint64_t total = 0;
  for (const auto& entry : fs::directory_iterator(options_.directory, failed)) {
    const fs::file_time_type used = entry.last_write_time(failed);
    const std::uint64_t bytes = failed ? 0 : entry.file_size(failed);
    if (failed) {
      continue;  // another program has removed it
    }
    const fs::path& file = entry.path();
    if (file.extension() == kUnfinished &&
        fs::file_time_type::clock::now() - used > kAbandonedAfter) {
      fs::remove(file, failed);
    } else if (file.extension() == kExtension) {
      total += bytes;
      files.push_back({used, file, bytes});
    }
  }
  std::sort(files.begin(), files.end(), [](const Kept& a, const Kept& b) {
    return std::tie(a.used, a.file) < std::tie(b.used, b.file);
  });
  for (const Kept& one : files) {
    if (total <= options_.most_bytes) {
      break;
    }
    if (one.file != kept && fs::remove(one.file, failed)) {
      total -= one.bytes;
    }
  }
}

std::optional<fs::path> cache_directory() {
  const auto folder = [](const char* variable) -> fs::path {
    const char* const value = std::getenv(variable);
    // systemd separates several folders by colons; a relative path is not usable.
    const std::string text = value == nullptr ? "" : value;
    const fs::path path = text.substr(0, text.find(':'));
    return path.is_absolute() ? path : fs::path();
  };
  if (fs::path own = folder("CACHE_DIRECTORY"); !own.empty()) {
    return own;
  }
  if (const fs::path xdg = folder("XDG_CACHE_HOME"); !xdg.empty()) {
    return xdg / "rayloc";
  }
  if (const fs::path home = folder("HOME"); !home.empty()) {
    return home / ".cache" / "rayloc";
  }
  return std::nullopt;
}

}  // namespace rayloc
