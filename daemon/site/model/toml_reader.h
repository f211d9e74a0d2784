// Reads TOML written by people: every access states the expected value, every error its place.
//
//   auto document = TomlDocument::read("site.toml");
//   TomlTable root = (*document)->root();
//   root.require({{"name", "name = \"office\""}});
//   const double height = root.number("height_m", {.min = 0.0, .unit = "m"}).value_or(1.2);
//   return (*document)->finish();   // all errors, including unrequested keys
//
// Errors are collected, not thrown: an accessor that finds an error records it and returns empty,
// as it does for an absent key. Reading continues with a default, and finish() reports that the
// values are unusable. A key is a known key once it has been requested, present or not.
//
// Included only by the .cpp files that read a file: it includes toml++.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "daemon/site/model/number_range.h"
#include "engine/base/expected.h"

namespace rayloc {

struct TomlPosition {
  std::uint32_t line = 1;
  std::uint32_t column = 1;  // in characters, from 1
  // The place in an included file; null in the document's own.
  std::shared_ptr<const std::string> included_file = nullptr;
};

// A key that must be present, and an example.
struct RequiredKey {
  std::string_view key;
  std::string_view example;  // "id = \"ap1\""
};

class TomlDocument;

// A table of a document; a cheap handle that must not outlive its document.
class TomlTable {
 public:
  TomlTable(TomlDocument& document, const toml::table& table, std::string name)
      : document_(&document), table_(&table), name_(std::move(name)) {}

  const std::string& name() const { return name_; }   // "[carrier]", for messages
  TomlPosition position() const;                      // place of its header
  TomlPosition position(std::string_view key) const;  // place of the key's value, or of the table
  // Place of an entry, from 0, of the key's array; otherwise as position(key).
  TomlPosition position(std::string_view key, std::size_t entry) const;
  bool has(std::string_view key) const { return table_->contains(key); }
  bool is_string(std::string_view key) const;
  // Marks the key as a known key without reading it.
  void ask_for(std::string_view key) const { ask(key); }

  // Records an error for each key that is absent.
  void require(std::initializer_list<RequiredKey> keys) const;

  std::optional<bool> boolean(std::string_view key) const;
  std::optional<std::int64_t> integer(std::string_view key, const NumberRange& range) const;
  // Integers are numbers as well. NaN and infinity are rejected.
  std::optional<double> number(std::string_view key, const NumberRange& range) const;
  // Not empty, without control characters.
  std::optional<std::string> string(std::string_view key) const;
  // One of `names`.
  std::optional<std::string> choice(std::string_view key,
                                    std::span<const std::string_view> names) const;
  // A path; relative ones start at the folder of the file that states it.
  std::optional<std::filesystem::path> path(std::string_view key) const;

  // An array of `count` numbers; `example` is a whole line with valid input.
  template <std::size_t kCount>
  std::optional<std::array<double, kCount>> numbers(std::string_view key,
                                                    std::string_view example) const {
    std::array<double, kCount> values{};
    const toml::node* node = ask(key);
    return node != nullptr && read_numbers(*node, key, values, example) ? std::optional(values)
                                                                        : std::nullopt;
  }
  // An array of pairs of numbers, each with its position.
  struct Pair {
    std::array<double, 2> values{};
    TomlPosition position;
  };
  std::optional<std::vector<Pair>> pairs(std::string_view key, std::string_view example) const;

  // One value, or an array of one or more of them; empty if absent or wrong.
  std::vector<bool> booleans(std::string_view key) const;
  std::vector<double> numbers(std::string_view key, const NumberRange& range) const;
  std::vector<std::string> strings(std::string_view key) const;
  std::vector<std::filesystem::path> paths(std::string_view key) const;  // as path()
  bool is_array(std::string_view key) const;

  std::optional<TomlTable> table(std::string_view key) const;
  // [[key]]; empty if absent.
  std::vector<TomlTable> tables(std::string_view key) const;
  // The tables [key.NAME], in order of the name.
  std::vector<std::pair<std::string, TomlTable>> named_tables(std::string_view key) const;

  const std::filesystem::path& file() const;  // of the document
  // "raylocd.toml:4:1: ", the prefix of errors.
  std::string place() const;
  std::string place(std::string_view key, std::size_t entry) const;  // as position()

  // Records an error at the key's value, or at the table's header.
  void error_at(std::string_view key, std::string message) const;
  void error_at(std::string_view key, std::size_t entry, std::string message) const;
  void error(std::string message) const;

 private:
  const toml::node* ask(std::string_view key) const;
  TomlPosition begin_of(const toml::node& node) const;
  std::string child_name(std::string_view key, bool array) const;
  void wrong_type(const toml::node& node, std::string_view key, std::string_view wanted) const;
  std::vector<const toml::node*> one_or_more(std::string_view key) const;
  bool read_numbers(const toml::node& node,
                    std::string_view key,
                    std::span<double> values,
                    std::string_view example) const;

  TomlDocument* document_;
  const toml::table* table_;
  std::string name_;
};

class TomlDocument {
 public:
  // Errors: a file that cannot be read, is too large for a handwritten one, or is not TOML.
  static Expected<std::unique_ptr<TomlDocument>> read(const std::filesystem::path& file);
  // `file` is for messages and for relative paths.
  static Expected<std::unique_ptr<TomlDocument>> parse(std::string_view text,
                                                       const std::filesystem::path& file);

  // Adds the content of the files that match the array of patterns at the root's `key` (glob(7),
  // from the document's folder, in alphabetical order): keys to their tables, tables to their
  // arrays. A key that two files state is an error, so that no order of files can matter. A pattern
  // without wildcards must name a file. To be called before any value is read.
  void include(std::string_view key);

  TomlTable root() { return {*this, root_, ""}; }
  // Replaces the table [name] if the document has none.
  TomlTable empty_table(const std::string& name) { return {*this, empty_, "[" + name + "]"}; }
  const std::filesystem::path& file() const { return file_; }
  // Files named by the keys that were requested, in this order: TomlTable::path().
  const std::vector<std::filesystem::path>& named_paths() const { return named_paths_; }

  void error(TomlPosition position, std::string message);

  // All errors by line and column, one a line, including unknown keys; kConfiguration.
  Expected<void> finish();

 private:
  friend class TomlTable;
  struct Note {
    TomlPosition position;
    std::string message;
  };
  struct Asked {
    std::string name;
    std::set<std::string, std::less<>> keys;
  };

  TomlDocument(std::filesystem::path file, toml::table root);
  void note_unknown_keys();
  std::string place(const TomlPosition& position) const;
  TomlPosition begin_of(const toml::source_region& region) const;
  void include_file(const std::filesystem::path& file, const TomlPosition& named_at);
  void merge(toml::table& from, toml::table& into, int depth);
  void merge_node(const toml::key& key, toml::node& from, toml::table& into, int depth);

  std::filesystem::path file_;
  toml::table root_;
  toml::table empty_;
  std::map<const toml::table*, Asked> asked_;
  std::vector<Note> notes_;
  std::vector<std::string> broken_files_;  // reasons why included files are not TOML, one each
  std::vector<std::filesystem::path> named_paths_;
};

// The shortest text that parses to the number: "0.2", "5190000000".
std::string to_text(double value);
// "[1.5, -2]".
std::string pair_text(const std::complex<double>& value);

// A key or a value in an error: "'name'".
std::string in_single_quotes(std::string_view text);

}  // namespace rayloc
