// Shared by the tests of site.toml and raylocd.toml: a valid text with one change, and the
// messages about it without the folder of this checkout.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rayloc::testing {

// `text` with the first `from` replaced by `to`.
inline std::string edited_text(std::string text, std::string_view from, std::string_view to) {
  if (!from.empty()) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) {
      return "the test's text lacks: " + std::string(from);  // a syntax error, and so a failure
    }
    text.replace(at, from.size(), to);
  }
  return text;
}

// `message` with every occurrence of the folder of `file` removed: "site.toml:3:1: ...".
inline std::string without_folder(std::string message, const std::filesystem::path& file) {
  const std::string folder = file.parent_path().string() + "/";
  for (std::size_t at = 0; (at = message.find(folder, at)) != std::string::npos;) {
    message.erase(at, folder.size());
  }
  return message;
}

}  // namespace rayloc::testing
