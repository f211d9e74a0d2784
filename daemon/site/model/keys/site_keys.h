// The table of every key of site.toml: names, valid values, meanings.
//
// The parser reads through it (SiteTable), and the manual page site.toml(5) and the JSON schema are
// generated from it (daemon/live/config/site_reference.h). A key without a row cannot be read; a
// row without a reader is an unknown key in a file that states it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/site/model/number_range.h"
#include "daemon/site/model/toml_reader.h"
#include "engine/base/check.h"

namespace rayloc {

enum class SiteType {
  kBoolean,
  kInteger,
  kNumber,
  kText,
  kChoice,   // one of `choices`
  kFile,     // a path relative to the folder of site.toml
  kNumbers,  // an array of `count` numbers
  kPairs,    // an array of pairs of numbers, `count` at least
  kTable,
  kTables,       // [[key]]
  kNamedTables,  // [key.NAME]
};

struct SiteKey {
  std::string_view table = {};  // "carrier", "access_point.antenna"; "" for the top of the file
  std::string_view key = {};
  SiteType type = SiteType::kText;
  bool required = false;
  std::string_view preset = {};   // the default in TOML, empty if there is none
  std::string_view example = {};  // an example line; for a table, its content
  NumberRange range = {};         // range of each number
  std::size_t count = 0;          // for kNumbers and kPairs
  std::span<const std::string_view> choices = {};
  std::span<const int> numbers = {};  // for kInteger: the only valid values
  std::string_view with = {};         // key to be stated if and only if this one is
  std::string_view without = {};      // a key that may not be stated beside this one
  std::string_view description = {};  // one line
};

// In the order of the manual page. The keys of a table are adjacent, after its own row.
std::span<const SiteKey> site_keys();

// REQUIRES: the row exists.
const SiteKey& site_key(std::string_view table, std::string_view key);

// "access_point.antenna" for that row of "access_point".
std::string table_of(const SiteKey& key);

// True if the value is a table, or several.
bool holds_table(const SiteKey& key);

// A table of site.toml that is read by the rows of site_keys(): errors are recorded as in
// TomlTable. REQUIRES for every accessor: the row has that type.
class SiteTable {
 public:
  // Records missing keys of the table, and keys that exclude or require each other.
  SiteTable(TomlTable table, std::string name);

  const TomlTable& toml() const { return table_; }
  bool has(std::string_view key) const { return table_.has(key); }
  // Records an error if a key is missing that only some such tables need.
  void require(std::string_view key) const;
  void error_at(std::string_view key, std::string message) const;

  std::optional<bool> boolean(std::string_view key) const;
  std::optional<std::int64_t> integer(std::string_view key) const;
  std::optional<double> number(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;
  std::optional<std::string> choice(std::string_view key) const;
  // A file that exists.
  std::optional<std::filesystem::path> file(std::string_view key) const;
  template <std::size_t kCount>
  std::optional<std::array<double, kCount>> numbers(std::string_view key) const {
    const SiteKey& row = row_of(key, SiteType::kNumbers);
    RAYLOC_CHECK(row.count == kCount);
    return table_.numbers<kCount>(key, row.example);
  }
  std::optional<std::vector<TomlTable::Pair>> pairs(std::string_view key) const;

  std::optional<SiteTable> table(std::string_view key) const;
  std::vector<SiteTable> tables(std::string_view key) const;
  std::vector<std::pair<std::string, SiteTable>> named_tables(std::string_view key) const;

 private:
  const SiteKey& row_of(std::string_view key, SiteType type) const;

  TomlTable table_;
  std::string name_;
};

}  // namespace rayloc
