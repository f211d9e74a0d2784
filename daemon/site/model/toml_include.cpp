#include <system_error>

#include "daemon/site/model/file_pattern.h"
#include "daemon/site/model/toml_reader.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

// The reason why a file that is named without wildcards was not found.
std::string reason_of_absence(const fs::path& file) {
  std::error_code failed;
  if (!fs::exists(file, failed) && failed) {
    return "cannot be read: " + failed.message();
  }
  return "is not there; paths are taken from the folder of this file";
}

// toml++ stores the path of the stated text; two notations may denote one file.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code failed;
  return fs::equivalent(a, b, failed) && !failed;
}

}  // namespace

void TomlDocument::include(std::string_view key) {
  const TomlTable top = root();
  const TomlPosition named_at = top.position(key);
  for (const std::string& pattern : top.strings(key)) {
    const fs::path whole = file_.parent_path() / pattern;
    const FileMatches found = match_files(whole);
    if (found.files.empty() && !has_wildcard(pattern)) {
      error(named_at, "'" + pattern + "' " + reason_of_absence(whole));
    }
    for (const std::string& folder : found.unreadable) {
      error(named_at, "'" + pattern + "': cannot list " + folder);
    }
    for (const fs::path& file : found.files) {
      if (is_same_file(file, file_)) {
        error(named_at, "'" + pattern + "' names this very file");
      } else {
        include_file(file, named_at);
      }
    }
  }
}

void TomlDocument::include_file(const fs::path& file, const TomlPosition& named_at) {
  const Expected<std::unique_ptr<TomlDocument>> other = read(file);
  if (!other) {
    broken_files_.push_back(other.error().message);
    return;
  }
  if (const toml::node* nested = (*other)->root_.get("include")) {
    error(begin_of(nested->source()),
          "an included file includes no others; add them to 'include' of " + file_.string() + ":" +
              std::to_string(named_at.line));
    (*other)->root_.erase("include");
  }
  merge((*other)->root_, root_, 1);
}

void TomlDocument::merge(toml::table& from, toml::table& into, int depth) {
  for (auto&& [key, node] : from) {
    merge_node(key, node, into, depth);
  }
}

// Nodes are moved: toml++ drops the places of copied ones.
void TomlDocument::merge_node(const toml::key& key,
                              toml::node& from,
                              toml::table& into,
                              int depth) {
  toml::node* there = into.get(key.str());
  if (there == nullptr) {
    from.visit([&](auto& node) { into.insert(key, std::move(node)); });
    return;
  }
  if (from.is_table() && there->is_table() && depth > 0) {
    merge(*from.as_table(), *there->as_table(), depth - 1);
    return;
  }
  if (from.is_array_of_tables() && there->is_array_of_tables()) {
    for (toml::node& entry : *from.as_array()) {
      there->as_array()->push_back(std::move(*entry.as_table()));
    }
    return;
  }
  std::string first = place(begin_of(there->source()));
  first.resize(first.size() - std::string_view(": ").size());
  error(begin_of(from.source()),
        "'" + std::string(key.str()) + "' is stated already at " + first + "; leave one of them");
}

}  // namespace rayloc
