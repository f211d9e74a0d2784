#include <algorithm>
#include <system_error>

#include "daemon/site/model/keys/site_keys.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

// "20, 40, 80 or 160".
std::string list_of_numbers(std::span<const int> numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    text += i == 0 ? "" : i + 1 == numbers.size() ? " or " : ", ";
    text += std::to_string(numbers[i]);
  }
  return text;
}

}  // namespace

const SiteKey& site_key(std::string_view table, std::string_view key) {
  const std::span<const SiteKey> keys = site_keys();
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const SiteKey& row) {
    return row.table == table && row.key == key;
  });
  RAYLOC_CHECK(found != keys.end());
  return *found;
}

std::string table_of(const SiteKey& key) {
  return (key.table.empty() ? "" : std::string(key.table) + ".") + std::string(key.key);
}

bool holds_table(const SiteKey& key) {
  return key.type == SiteType::kTable || key.type == SiteType::kTables ||
         key.type == SiteType::kNamedTables;
}

SiteTable::SiteTable(TomlTable table, std::string name)
    : table_(std::move(table)), name_(std::move(name)) {
  for (const SiteKey& row : site_keys()) {
    if (row.table != name_) {
      continue;
    }
    if (row.required) {
      require(row.key);
    }
    if (!row.with.empty() && has(row.key) != has(row.with)) {
      table_.error(table_.name() + " states one of " + in_single_quotes(row.with) + " and " +
                   in_single_quotes(row.key) + "; write both or none");
    }
    if (!row.without.empty() && has(row.key) && has(row.without)) {
      table_.error_at(row.key,
                      in_single_quotes(row.without) + " is stated as well; keep one of the two");
    }
  }
}

const SiteKey& SiteTable::row_of(std::string_view key, SiteType type) const {
  const SiteKey& row = site_key(name_, key);
  RAYLOC_CHECK(row.type == type);
  return row;
}

void SiteTable::require(std::string_view key) const {
  table_.require({{key, site_key(name_, key).example}});
}

void SiteTable::error_at(std::string_view key, std::string message) const {
  table_.error_at(key, std::move(message));
}

std::optional<bool> SiteTable::boolean(std::string_view key) const {
  return table_.boolean(row_of(key, SiteType::kBoolean).key);
}

std::optional<std::int64_t> SiteTable::integer(std::string_view key) const {
  const SiteKey& row = row_of(key, SiteType::kInteger);
  if (row.numbers.empty()) {
    return table_.integer(key, row.range);
  }
  const auto value = table_.integer(key, {.unit = row.range.unit});
  if (value && std::find(row.numbers.begin(), row.numbers.end(), *value) == row.numbers.end()) {
    table_.error_at(key,
                    in_single_quotes(key) + " is " + std::to_string(*value) + "; write " +
                        list_of_numbers(row.numbers));
    return std::nullopt;
  }
  return value;
}

std::optional<double> SiteTable::number(std::string_view key) const {
  return table_.number(key, row_of(key, SiteType::kNumber).range);
}

std::optional<std::string> SiteTable::text(std::string_view key) const {
  return table_.string(row_of(key, SiteType::kText).key);
}

std::optional<std::string> SiteTable::choice(std::string_view key) const {
  return table_.choice(key, row_of(key, SiteType::kChoice).choices);
}

std::optional<fs::path> SiteTable::file(std::string_view key) const {
  std::optional<fs::path> file = table_.path(row_of(key, SiteType::kFile).key);
  std::error_code status;
  if (file && !fs::is_regular_file(*file, status)) {
    table_.error_at(key,
                    in_single_quotes(key) + ": no file " + file->string() +
                        "; paths are relative to the folder of " +
                        table_.file().filename().string());
    return std::nullopt;
  }
  return file;
}

std::optional<std::vector<TomlTable::Pair>> SiteTable::pairs(std::string_view key) const {
  return table_.pairs(key, row_of(key, SiteType::kPairs).example);
}

std::optional<SiteTable> SiteTable::table(std::string_view key) const {
  const SiteKey& row = row_of(key, SiteType::kTable);
  const std::optional<TomlTable> found = table_.table(key);
  return found ? std::optional<SiteTable>(std::in_place, *found, table_of(row)) : std::nullopt;
}

std::vector<SiteTable> SiteTable::tables(std::string_view key) const {
  const SiteKey& row = row_of(key, SiteType::kTables);
  std::vector<SiteTable> result;
  for (const TomlTable& each : table_.tables(key)) {
    result.emplace_back(each, table_of(row));
  }
  return result;
}

std::vector<std::pair<std::string, SiteTable>> SiteTable::named_tables(std::string_view key) const {
  const SiteKey& row = row_of(key, SiteType::kNamedTables);
  std::vector<std::pair<std::string, SiteTable>> result;
  for (const auto& [name, each] : table_.named_tables(key)) {
    result.emplace_back(name, SiteTable(each, table_of(row)));
  }
  return result;
}

}  // namespace rayloc
