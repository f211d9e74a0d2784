#include <algorithm>

#include "capture/source/transport_schemes.h"
#include "daemon/live/config/config_reader.h"

namespace rayloc {
namespace {

constexpr std::string_view kIntroduction =
    "# Configuration of raylocd. Every key there is; a line that begins with #key shows the "
    "default\n# or an example and may be left out. Check with: rayloc check-config FILE\n"
    "# Relative paths are taken from the folder of this file.\n";

std::string text_in_toml(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' || c == '\\' ? "\\" : "";
    result += c;
  }
  return result + "\"";
}

std::string section_header(std::string_view section, bool has_site_list = false) {
  if (section.empty()) {
    return "";
  }
  const bool listed = section == "source" || (section == "site" && has_site_list);
  return listed ? "[[" + std::string(section) + "]]\n" : "[" + std::string(section) + "]\n";
}

std::string described_line(const ConfigOption& option) {
  std::string lines = "# " + std::string(option.description);
  if (!option.only_kinds.empty() && option.type != ConfigType::kUrl) {
    lines += " (kind " + std::string(option.only_kinds) + ")";
  }
  if (const std::string range = config_limits(option); !range.empty()) {
    lines += ": " + range;
  }
  return lines + "\n" + (option.required ? "" : "#") + std::string(option.key) + " = " +
         std::string(option.preset.empty() ? option.example : option.preset) + "\n";
}

}  // namespace

std::string config_limits(const ConfigOption& option) {
  if (!option.choices.empty()) {
    std::string names;
    for (std::size_t i = 0; i < option.choices.size(); ++i) {
      const bool last = i + 1 == option.choices.size();
      names += i == 0 ? "" : last ? " or " : ", ";
      names += text_in_toml(option.choices[i]);
    }
    return names + (option.type == ConfigType::kMethods ? "; or several as an array" : "");
  }
  if (option.type == ConfigType::kUrl) {
    return transport_syntax(transport_schemes(), TransportUse::kSource);
  }
  if (option.type == ConfigType::kInteger || option.type == ConfigType::kNumber ||
      option.type == ConfigType::kSpeed) {
    return to_text(option.range.min) +
           (option.range.min < option.range.max ? " to " + to_text(option.range.max) : "") +
           (option.range.unit.empty() ? "" : " " + std::string(option.range.unit));
  }
  return "";
}

std::string to_toml(const ConfigValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) {
    return *flag ? "true" : "false";
  }
  if (const std::int64_t* integer = std::get_if<std::int64_t>(&value)) {
    return std::to_string(*integer);
  }
  if (const double* number = std::get_if<double>(&value)) {
    return to_text(*number);
  }
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    std::string list;
    for (const std::string& text : *texts) {
      list += (list.empty() ? "" : ", ") + text_in_toml(text);
    }
    return "[" + list + "]";
  }
  return text_in_toml(std::get<std::string>(value));
}

std::string config_example() {
  std::string text(kIntroduction);
  std::string_view section = "none";
  for (const ConfigOption& option : config_options()) {
    if (option.section != section) {
      section = option.section;
      text += section == "source" ? "\n# Once for each access point." : "";
      text += section == "site" ? "\n# Or [[site]], once for each of several." : "";
      text += "\n" + section_header(section);
    }
    text += described_line(option);
  }
  return text;
}

Expected<std::string> effective_config(const std::filesystem::path& file) {
  const auto document = read_files(file);
  RAYLOC_TRY(document);
  const ConfigReading reading = read_config(**document);
  RAYLOC_TRY((*document)->finish());
  std::string text;
  for (const ConfigSection& section : reading.sections) {
    if (section.entries.empty()) {
      continue;
    }
    text += (text.empty() ? "" : "\n") + section_header(section.name, reading.config.has_site_list);
    for (const ConfigEntry& entry : section.entries) {
      text += std::string(entry.option->key) + " = " + to_toml(entry.value) +
              (entry.stated ? "" : "  # default") + "\n";
    }
  }
  return text;
}

}  // namespace rayloc
