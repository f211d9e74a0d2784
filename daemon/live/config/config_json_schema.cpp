#include <nlohmann/json.hpp>

#include "capture/source/transport_schemes.h"
#include "daemon/live/config/config_schema.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

// For the literals in the table: numbers, true, false and plain text are identical in JSON.
Json literal(std::string_view toml) { return Json::parse(toml); }

Json bounds(const ConfigOption& option, const char* type) {
  return {{"type", type}, {"minimum", option.range.min}, {"maximum", option.range.max}};
}

Json names_of(std::span<const std::string_view> choices) {
  Json names = Json::array();
  for (const std::string_view name : choices) {
    names.push_back(std::string(name));
  }
  return {{"type", "string"}, {"enum", names}};
}

// A name, or several: "none" is valid on its own only, and is the last.
Json methods_of(const ConfigOption& option) {
  const Json several = {{"type", "array"},
                        {"items", names_of(option.choices.first(option.choices.size() - 1))},
                        {"minItems", 1},
                        {"maxItems", kMaxMethods},
                        {"uniqueItems", true}};
  return {{"anyOf", Json::array({names_of(option.choices), several})}};
}

std::string url_pattern() {
  std::string schemes;
  for (const TransportScheme& row : transport_schemes()) {
    if (row.open_source != nullptr) {
      schemes += (schemes.empty() ? "" : "|") + std::string(row.name);
    }
  }
  return "^(" + schemes + "):.";
}

Json type_of(const ConfigOption& option) {
  switch (option.type) {
    case ConfigType::kBoolean:
      return {{"type", "boolean"}};
    case ConfigType::kInteger:
      return bounds(option, "integer");
    case ConfigType::kNumber:
      return bounds(option, "number");
    case ConfigType::kText:
    case ConfigType::kFolder:
    case ConfigType::kFile:
      return {{"type", "string"}, {"minLength", 1}};
    case ConfigType::kChoice:
      return names_of(option.choices);
    case ConfigType::kMethods:
      return methods_of(option);
    case ConfigType::kSpeed:
      return {{"anyOf", Json::array({bounds(option, "number"), {{"const", "max"}}})}};
    case ConfigType::kFiles: {
      const Json text = {{"type", "string"}, {"minLength", 1}};
      return {
          {"anyOf", Json::array({text, {{"type", "array"}, {"items", text}, {"minItems", 1}}})}};
    }
    case ConfigType::kUrl:
      return {{"type", "string"}, {"pattern", url_pattern()}};
    case ConfigType::kTexts:
      return {{"type", "array"}, {"items", {{"type", "string"}, {"minLength", 1}}}};
  }
  RAYLOC_CHECK(false);
}

Json empty_object() {
  return {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
}

void add_option(const ConfigOption& option, Json& object) {
  Json property = type_of(option);
  property["description"] = std::string(option.description);
  if (!option.preset.empty()) {
    property["default"] = literal(option.preset);
  }
  if (!option.range.unit.empty()) {
    property["x-unit"] = std::string(option.range.unit);
  }
  const std::string key(option.key);
  object["properties"][key] = std::move(property);
  if (option.required && option.in_url) {
    object["oneOf"] = {{{"required", Json::array({key})}}, {{"required", Json::array({"url"})}}};
  } else if (option.required) {
    object["required"].push_back(key);
  }
}

}  // namespace

std::string config_json_schema() {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Configuration of raylocd"}};
  schema.update(empty_object());
  schema["required"] = Json::array({"site", "source"});
  Json& sections = schema["properties"];
  for (const ConfigOption& option : config_options()) {
    const std::string section(option.section);
    if (section.empty()) {
      add_option(option, schema);
      continue;
    }
    if (!sections.contains(section)) {
      sections[section] = section == "source"
                              ? Json{{"type", "array"}, {"minItems", 1}, {"items", empty_object()}}
                              : empty_object();
    }
    add_option(option, section == "source" ? sections[section]["items"] : sections[section]);
  }
  Json site = std::move(sections["site"]);
  sections["site"] = {
      {"anyOf", Json::array({site, {{"type", "array"}, {"minItems", 1}, {"items", site}}})}};
  return schema.dump(2) + "\n";
}

}  // namespace rayloc
