#include "daemon/site/model/toml_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

bool has_control_character(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
}

std::string range_text(const NumberRange& range) {
  const std::string unit = range.unit.empty() ? "" : " " + std::string(range.unit);
  if (std::isinf(range.max)) {
    return "at least " + to_text(range.min) + unit;
  }
  if (std::isinf(range.min)) {
    return "at most " + to_text(range.max) + unit;
  }
  return "from " + to_text(range.min) + " to " + to_text(range.max) + unit;
}

}  // namespace

std::string in_single_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }

std::string to_text(double value) {
  std::array<char, 32> buffer{};
  // Integers that a double represents exactly without an exponent: 5190000000, not 5.19e+09.
  const bool whole = std::abs(value) < 1e15 && value == std::trunc(value);
  const auto result =
      whole ? std::to_chars(
                  buffer.data(), buffer.data() + buffer.size(), static_cast<std::int64_t>(value))
            : std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

TomlPosition TomlTable::begin_of(const toml::node& node) const {
  return document_->begin_of(node.source());
}

TomlPosition TomlTable::position() const { return begin_of(*table_); }

TomlPosition TomlTable::position(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr ? begin_of(*node) : position();
}

TomlPosition TomlTable::position(std::string_view key, std::size_t entry) const {
  const toml::array* array = table_->get_as<toml::array>(key);
  const toml::node* node = array != nullptr ? array->get(entry) : nullptr;
  return node != nullptr ? begin_of(*node) : position(key);
}

std::string TomlTable::place() const { return document_->place(position()); }

std::string TomlTable::place(std::string_view key, std::size_t entry) const {
  return document_->place(position(key, entry));
}

const std::filesystem::path& TomlTable::file() const { return document_->file(); }

bool TomlTable::is_string(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_string();
}

const toml::node* TomlTable::ask(std::string_view key) const {
  TomlDocument::Asked& asked = document_->asked_[table_];
  asked.name = name_;
  asked.keys.emplace(key);
  return table_->get(key);
}

std::string TomlTable::child_name(std::string_view key, bool array) const {
  std::string path = name_;
  path.erase(std::remove_if(path.begin(), path.end(), [](char c) { return c == '[' || c == ']'; }),
             path.end());
  path += (path.empty() ? "" : ".") + std::string(key);
  return array ? "[[" + path + "]]" : "[" + path + "]";
}

void TomlTable::require(std::initializer_list<RequiredKey> keys) const {
  for (const RequiredKey& required : keys) {
    if (ask(required.key) == nullptr) {
      error((name_.empty() ? "the file" : name_) + " lacks " + in_single_quotes(required.key) +
            "; add, for example: " + std::string(required.example));
    }
  }
}

void TomlTable::error_at(std::string_view key, std::string message) const {
  document_->error(position(key), std::move(message));
}

void TomlTable::error_at(std::string_view key, std::size_t entry, std::string message) const {
  document_->error(position(key, entry), std::move(message));
}

void TomlTable::error(std::string message) const {
  document_->error(position(), std::move(message));
}

void TomlTable::wrong_type(const toml::node& node,
                           std::string_view key,
                           std::string_view wanted) const {
  document_->error(begin_of(node),
                   in_single_quotes(key) + " is " + std::string(type_name(node)) + "; write " +
                       std::string(wanted));
}

std::optional<bool> TomlTable::boolean(std::string_view key) const {
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_boolean()) {
    wrong_type(*node, key, "true or false without quotes: " + std::string(key) + " = true");
    return std::nullopt;
  }
  return node->as_boolean()->get();
}

std::optional<std::int64_t> TomlTable::integer(std::string_view key,
                                               const NumberRange& range) const {
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_integer()) {
    wrong_type(*node, key, "a whole number without quotes, " + range_text(range));
    return std::nullopt;
  }
  const std::int64_t value = node->as_integer()->get();
  if (static_cast<double>(value) < range.min || static_cast<double>(value) > range.max) {
    error_at(key,
             in_single_quotes(key) + " is " + std::to_string(value) + "; it must be " +
                 range_text(range));
    return std::nullopt;
  }
  return value;
}

std::optional<double> TomlTable::number(std::string_view key, const NumberRange& range) const {
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_number()) {
    wrong_type(*node, key, "a number without quotes, " + range_text(range));
    return std::nullopt;
  }
  const double value = *node->value<double>();
  if (!std::isfinite(value) || value < range.min || value > range.max) {
    error_at(key,
             in_single_quotes(key) + " is " + to_text(value) + "; it must be " + range_text(range));
    return std::nullopt;
  }
  return value;
}

std::optional<std::string> TomlTable::string(std::string_view key) const {
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_string()) {
    wrong_type(*node, key, "text in double quotes: " + std::string(key) + " = \"...\"");
    return std::nullopt;
  }
  const std::string& value = node->as_string()->get();
  if (value.empty()) {
    error_at(key, in_single_quotes(key) + " is empty; write a text or leave the key out");
    return std::nullopt;
  }
  if (has_control_character(value)) {
    error_at(key,
             in_single_quotes(key) +
                 " contains a control character; write it on one line, without tabs");
    return std::nullopt;
  }
  return value;
}

std::optional<std::string> TomlTable::choice(std::string_view key,
                                             std::span<const std::string_view> names) const {
  std::optional<std::string> value = string(key);
  if (value && std::find(names.begin(), names.end(), *value) == names.end()) {
    error_at(key,
             in_single_quotes(*value) + " is no value of " + in_single_quotes(key) +
                 suggestion(*value, names));
    return std::nullopt;
  }
  return value;
}

std::optional<std::filesystem::path> TomlTable::path(std::string_view key) const {
  const std::optional<std::string> value = string(key);
  if (!value) {
    return std::nullopt;
  }
  const TomlPosition at = position(key);
  const std::filesystem::path stated_in =
      at.included_file ? std::filesystem::path(*at.included_file) : document_->file();
  return document_->named_paths_.emplace_back(stated_in.parent_path() / *value);
}

bool TomlTable::read_numbers(const toml::node& node,
                             std::string_view key,
                             std::span<double> values,
                             std::string_view example) const {
  const std::string wanted =
      "an array of " + std::to_string(values.size()) + " numbers: " + std::string(example);
  const toml::array* array = node.as_array();
  if (array == nullptr) {
    wrong_type(node, key, wanted);
    return false;
  }
  if (array->size() != values.size()) {
    document_->error(begin_of(node),
                     in_single_quotes(key) + " has " + std::to_string(array->size()) +
                         " entries; write " + wanted);
    return false;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const toml::node& entry = *array->get(i);
    if (!entry.is_number()) {
      document_->error(begin_of(entry),
                       "an entry of " + in_single_quotes(key) + " is " +
                           std::string(type_name(entry)) + "; write " + wanted);
      return false;
    }
    values[i] = *entry.value<double>();
    if (!std::isfinite(values[i])) {
      document_->error(begin_of(entry),
                       "an entry of " + in_single_quotes(key) + " is " + to_text(values[i]) +
                           "; write a finite number");
      return false;
    }
  }
  return true;
}

std::optional<std::vector<TomlTable::Pair>> TomlTable::pairs(std::string_view key,
                                                             std::string_view example) const {
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_array()) {
    wrong_type(*node, key, "an array of pairs of numbers: " + std::string(example));
    return std::nullopt;
  }
  std::vector<Pair> result;
  for (const toml::node& entry : *node->as_array()) {
    Pair pair{{}, begin_of(entry)};
    if (!read_numbers(entry, key, pair.values, example)) {
      return std::nullopt;
    }
    result.push_back(pair);
  }
  return result;
}

bool TomlTable::is_array(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_array();
}

std::vector<const toml::node*> TomlTable::one_or_more(std::string_view key) const {
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return {};
  }
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    return {node};
  }
  if (array->empty()) {
    error_at(key, in_single_quotes(key) + " is an empty array; write a value or leave the key out");
  }
  std::vector<const toml::node*> entries;
  for (const toml::node& entry : *array) {
    entries.push_back(&entry);
  }
  return entries;
}

std::vector<bool> TomlTable::booleans(std::string_view key) const {
  std::vector<bool> values;
  for (const toml::node* entry : one_or_more(key)) {
    if (!entry->is_boolean()) {
      wrong_type(*entry, key, "true or false without quotes, or an array of them");
      return {};
    }
    values.push_back(entry->as_boolean()->get());
  }
  return values;
}

std::vector<double> TomlTable::numbers(std::string_view key, const NumberRange& range) const {
  std::vector<double> values;
  for (const toml::node* entry : one_or_more(key)) {
    if (!entry->is_number()) {
      wrong_type(*entry, key, "a number without quotes, or an array of them, " + range_text(range));
      return {};
    }
    const double value = *entry->value<double>();
    if (!std::isfinite(value) || value < range.min || value > range.max) {
      document_->error(
          begin_of(*entry),
          in_single_quotes(key) + " is " + to_text(value) + "; it must be " + range_text(range));
      return {};
    }
    values.push_back(value);
  }
  return values;
}

std::vector<std::string> TomlTable::strings(std::string_view key) const {
  std::vector<std::string> values;
  for (const toml::node* entry : one_or_more(key)) {
    if (!entry->is_string()) {
      wrong_type(*entry, key, "text in double quotes, or an array of it");
      return {};
    }
    const std::string& value = entry->as_string()->get();
    if (value.empty() || has_control_character(value)) {
      document_->error(begin_of(*entry),
                       in_single_quotes(key) + " is empty or contains a control character");
      return {};
    }
    values.push_back(value);
  }
  return values;
}

std::vector<std::filesystem::path> TomlTable::paths(std::string_view key) const {
  std::vector<std::filesystem::path> values;
  for (const std::string& text : strings(key)) {
    const TomlPosition at = position(key);
    const std::filesystem::path stated_in =
        at.included_file ? std::filesystem::path(*at.included_file) : document_->file();
    values.push_back(document_->named_paths_.emplace_back(stated_in.parent_path() / text));
  }
  return values;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_table()) {
    wrong_type(*node, key, "a table: a line " + child_name(key, false) + ", its keys below it");
    return std::nullopt;
  }
  return TomlTable(*document_, *node->as_table(), child_name(key, false));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  std::vector<TomlTable> result;
  const toml::node* node = ask(key);
  if (node == nullptr) {
    return result;
  }
  const std::string name = child_name(key, true);
  const std::string wanted = "tables: a line " + name + " before each, its keys below it";
  if (!node->is_array()) {
    wrong_type(*node, key, wanted);
    return result;
  }
  for (const toml::node& entry : *node->as_array()) {
    if (entry.is_table()) {
      result.emplace_back(*document_, *entry.as_table(), name);
    } else {
      wrong_type(entry, key, wanted);
    }
  }
  return result;
}

std::vector<std::pair<std::string, TomlTable>> TomlTable::named_tables(std::string_view key) const {
  std::vector<std::pair<std::string, TomlTable>> result;
  const std::optional<TomlTable> parent = table(key);
  if (!parent) {
    return result;
  }
  for (const auto& [name, node] : *parent->table_) {
    if (const std::optional<TomlTable> child = parent->table(name.str())) {
      result.emplace_back(std::string(name.str()), *child);
    }
  }
  return result;
}

std::string pair_text(const std::complex<double>& value) {
  return "[" + to_text(value.real()) + ", " + to_text(value.imag()) + "]";
}

}  // namespace rayloc
