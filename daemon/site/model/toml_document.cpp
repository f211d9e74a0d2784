#include <algorithm>
#include <fstream>
#include <system_error>
#include <tuple>

#include "daemon/site/model/toml_reader.h"
#include "engine/base/printable.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

// No file written by hand is longer, and a wrong path (a recording) is rejected at once.
constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20U;
// Further errors are counted, not listed: they follow from the first ones.
constexpr std::size_t kMaxListed = 50;
// Our files nest three deep. toml++ bounds nested values but not dotted keys, and recurses over
// both: a.a.a.a... in a hostile file would exhaust the stack.
constexpr int kMaxDots = 8;

Error configuration_error(std::string message) {
  return {ErrorKind::kConfiguration, std::move(message)};
}

Expected<std::string> read_text_file(const std::filesystem::path& file) {
  std::error_code status;
  if (std::filesystem::is_directory(file, status)) {
    return tl::make_unexpected(configuration_error(file.string() + ": is a directory, not a file"));
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    const std::error_code why(errno, std::generic_category());
    return tl::make_unexpected(
        configuration_error(file.string() + ": cannot be opened: " + why.message()));
  }
  std::string text(kMaxFileBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) {
    return tl::make_unexpected(configuration_error(file.string() + ": cannot be read"));
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxFileBytes) {
    return tl::make_unexpected(configuration_error(
        file.string() + ": is larger than 1 MiB; this is no file that was written by hand"));
  }
  return text;
}

// Finds the place of a key with more than kMaxDots dots. Strings and comments are skipped as TOML
// defines them; a number has one dot, and separators of numbers start a new count.
class DotCounter {
 public:
  explicit DotCounter(std::string_view text) : text_(text) {}

  // The line of the first such key, 0 if there is none.
  std::uint32_t first_deep_line() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        skip_string(c);
        continue;
      }
      if (c == '#') {
        skip_to('\n');
        continue;
      }
      if (c == '.' && ++dots_ > kMaxDots) {
        return line_;
      }
      if (c == '\n' || c == ',' || c == '=' || c == '[' || c == ']' || c == '{' || c == '}') {
        dots_ = 0;
      }
      step();
    }
    return 0;
  }

 private:
  void step() {
    line_ += text_[at_] == '\n' ? 1U : 0U;
    ++at_;
  }
  void skip_to(char end) {
    while (at_ < text_.size() && text_[at_] != end) {
      step();
    }
  }
  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool multi_line = text_.substr(at_, 3) == triple;
    const std::string_view end = std::string_view(triple).substr(0, multi_line ? 3 : 1);
    at_ += end.size();
    while (at_ < text_.size() && text_.substr(at_, end.size()) != end) {
      if (!multi_line && text_[at_] == '\n') {
        return;  // not closed: the parser reports it
      }
      if (quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size()) {
        step();
      }
      step();
    }
    at_ = std::min(at_ + end.size(), text_.size());
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1;
  int dots_ = 0;
};

std::string place_in(const std::string& file, std::uint32_t line, std::uint32_t column) {
  return file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

}  // namespace

TomlDocument::TomlDocument(std::filesystem::path file, toml::table root)
    : file_(std::move(file)), root_(std::move(root)) {}

Expected<std::unique_ptr<TomlDocument>> TomlDocument::read(const std::filesystem::path& file) {
  const Expected<std::string> text = read_text_file(file);
  RAYLOC_TRY(text);
  return parse(*text, file);
}

Expected<std::unique_ptr<TomlDocument>> TomlDocument::parse(std::string_view text,
                                                            const std::filesystem::path& file) {
  if (const std::uint32_t line = DotCounter(text).first_deep_line(); line != 0) {
    return tl::make_unexpected(configuration_error(
        place_in(file.string(), line, 1) + "a key with more than " + std::to_string(kMaxDots) +
        " dots; no key of this file is nested that deep"));
  }
  try {
    return std::unique_ptr<TomlDocument>(
        new TomlDocument(file, toml::parse(text, std::string_view(file.native()))));
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    std::string_view what = error.description();
    constexpr std::string_view kPrefix = "Error while ";
    if (what.substr(0, kPrefix.size()) == kPrefix) {
      what.remove_prefix(kPrefix.size());
    }
    return tl::make_unexpected(configuration_error(place_in(file.string(), at.line, at.column) +
                                                   "not TOML: " + std::string(what)));
  }
}

std::string TomlDocument::place(const TomlPosition& position) const {
  return place_in(position.included_file ? *position.included_file : file_.string(),
                  position.line,
                  position.column);
}

TomlPosition TomlDocument::begin_of(const toml::source_region& region) const {
  const bool own = !region.path || *region.path == file_.native();
  return {region.begin.line, region.begin.column, own ? nullptr : region.path};
}

void TomlDocument::error(TomlPosition position, std::string message) {
  // Messages quote the file; its content must not control the terminal.
  notes_.push_back({std::move(position), printable(std::move(message))});
}

void TomlDocument::note_unknown_keys() {
  for (const auto& [table, asked] : asked_) {
    const std::vector<std::string_view> known(asked.keys.begin(), asked.keys.end());
    for (const auto& [key, node] : *table) {
      if (asked.keys.find(key.str()) != asked.keys.end()) {
        continue;
      }
      error(begin_of(key.source()),
            "unknown key '" + std::string(key.str()) + "'" +
                (asked.name.empty() ? "" : " in " + asked.name) + suggestion(key.str(), known));
    }
  }
  asked_.clear();
}

Expected<void> TomlDocument::finish() {
  note_unknown_keys();
  if (notes_.empty() && broken_files_.empty()) {
    return {};
  }
  // Errors of the file itself first, then those of each included one.
  const auto rank = [](const TomlPosition& at) {
    return std::tuple(at.included_file ? *at.included_file : "", at.line, at.column);
  };
  std::stable_sort(notes_.begin(), notes_.end(), [&](const Note& a, const Note& b) {
    return rank(a.position) < rank(b.position);
  });
  std::string all;
  for (std::size_t i = 0; i < std::min(notes_.size(), kMaxListed); ++i) {
    all += (i > 0 ? "\n" : "") + place(notes_[i].position) + notes_[i].message;
  }
  for (const std::string& broken : broken_files_) {
    all += (all.empty() ? "" : "\n") + broken;
  }
  if (notes_.size() > kMaxListed) {
    all += "\n" + file_.string() + ": and " + std::to_string(notes_.size() - kMaxListed) +
           " more errors";
  }
  return tl::make_unexpected(configuration_error(std::move(all)));
}

}  // namespace rayloc
