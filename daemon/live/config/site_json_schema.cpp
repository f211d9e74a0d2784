#include <cmath>

#include <nlohmann/json.hpp>

#include "daemon/live/config/site_reference.h"
#include "daemon/site/model/keys/site_keys.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

Json number_within(const NumberRange& range, const char* type) {
  Json number = {{"type", type}};
  if (!std::isinf(range.min)) {
    number["minimum"] = range.min;
  }
  if (!std::isinf(range.max)) {
    number["maximum"] = range.max;
  }
  return number;
}

Json array_of(Json items, std::size_t least, std::size_t most) {
  Json array = {{"type", "array"}, {"items", std::move(items)}, {"minItems", least}};
  if (most > 0) {
    array["maxItems"] = most;
  }
  return array;
}

template <typename Value>
Json json_list(std::span<const Value> values) {
  Json list = Json::array();
  for (const Value& value : values) {
    list.push_back(value);
  }
  return list;
}

// The table `name` with its keys, and its nested tables with theirs.
Json object_of(const std::string& name);

Json value_of(const SiteKey& key) {
  switch (key.type) {
    case SiteType::kBoolean:
      return {{"type", "boolean"}};
    case SiteType::kInteger:
      return key.numbers.empty() ? number_within(key.range, "integer")
                                 : Json{{"enum", json_list(key.numbers)}};
    case SiteType::kNumber:
      return number_within(key.range, "number");
    case SiteType::kText:
    case SiteType::kFile:
      return {{"type", "string"}, {"minLength", 1}};
    case SiteType::kChoice:
      return {{"enum", json_list(key.choices)}};
    case SiteType::kNumbers:
      return array_of(number_within(key.range, "number"), key.count, key.count);
    case SiteType::kPairs:
      return array_of(array_of(number_within(key.range, "number"), 2, 2), key.count, 0);
    case SiteType::kTable:
      return object_of(table_of(key));
    case SiteType::kTables:
      return array_of(object_of(table_of(key)), key.required ? 1 : 0, 0);
    case SiteType::kNamedTables:
      return {{"type", "object"}, {"additionalProperties", object_of(table_of(key))}};
  }
  RAYLOC_CHECK(false);
}

// Literals of the table have the same form in TOML and JSON.
Json property_of(const SiteKey& key) {
  Json property = value_of(key);
  property["description"] = std::string(key.description);
  if (!key.preset.empty()) {
    property["default"] = Json::parse(key.preset);
  }
  if (const std::size_t equals = key.example.find(" = ");
      !holds_table(key) && equals != std::string_view::npos) {
    property["examples"] = Json::array({Json::parse(key.example.substr(equals + 3))});
  }
  if (!key.range.unit.empty()) {
    property["x-unit"] = std::string(key.range.unit);
  }
  return property;
}

Json object_of(const std::string& name) {
  Json object = {
      {"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
  for (const SiteKey& key : site_keys()) {
    if (key.table != name) {
      continue;
    }
    const std::string word(key.key);
    object["properties"][word] = property_of(key);
    if (key.required) {
      object["required"].push_back(word);
    }
    if (!key.with.empty()) {
      const std::string other(key.with);
      object["dependentRequired"] = {{word, Json::array({other})}, {other, Json::array({word})}};
    }
    if (!key.without.empty()) {
      object["not"] = {{"required", Json::array({word, std::string(key.without)})}};
    }
  }
  return object;
}

}  // namespace

std::string site_json_schema() {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "A site of RayLoc: site.toml"}};
  schema.update(object_of(""));
  return schema.dump(2) + "\n";
}

}  // namespace rayloc
