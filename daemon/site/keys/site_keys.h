// The table of every key of site.toml: what there is, what it may be, what it means.
//
// The parser reads through it (SiteTable), and the manual page site.toml(5) and the JSON schema are
// printed from it (daemon/config/site_reference.h). A key without a row cannot be read; a row that
// nobody reads is an unknown key to whoever states it.
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

#include "daemon/site/number_range.h"
#include "daemon/site/toml_reader.h"
#include "engine/base/check.h"

namespace rayloc {

enum class SiteType {
  kBoolean,
  kInteger,
  kNumber,
  kText,
  kChoice,   // one of `choices`
  kFile,     // a path from the folder of site.toml
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
  std::string_view preset = {};   // the default in TOML, empty when there is none
  std::string_view example = {};  // a line to write; of a table, what stands in it
  NumberRange range = {};         // of each number
  std::size_t count = 0;          // of kNumbers and kPairs
  std::span<const std::string_view> choices = {};
  std::span<const int> numbers = {};  // of kInteger: nothing but these
  std::string_view with = {};         // a key that is stated where this one is, and only there
  std::string_view without = {};      // a key that may not be stated beside this one
  std::string_view description = {};  // one line
};

// In the order of the manual page. The keys of a table stand together, behind its own row.
std::span<const SiteKey> site_keys();

// REQUIRES: there is such a row.
const SiteKey& site_key(std::string_view table, std::string_view key);

// "access_point.antenna" of that row of "access_point".
std::string table_of(const SiteKey& key);

// Whether the value is a table, or several.
bool holds_table(const SiteKey& key);

// A table of site.toml that is read by the rows of site_keys(): what is wrong is noted as TomlTable
// does. REQUIRES of every accessor: the row is of that type.
class SiteTable {
 public:
  // Notes what the table lacks, and keys that may not or must stand together.
  SiteTable(TomlTable table, std::string name);

  const TomlTable& toml() const { return table_; }
  bool has(std::string_view key) const { return table_.has(key); }
  // Notes an error where a key is missing that not every such table needs.
  void require(std::string_view key) const;
  void error_at(std::string_view key, std::string message) const;

  std::optional<bool> boolean(std::string_view key) const;
  std::optional<std::int64_t> integer(std::string_view key) const;
  std::optional<double> number(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;
  std::optional<std::string> choice(std::string_view key) const;
  // One that is there.
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
