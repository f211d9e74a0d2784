#include <cmath>

#include "daemon/base/roff.h"
#include "daemon/live/config/site_reference.h"
#include "daemon/site/model/keys/site_keys.h"

namespace rayloc {
namespace {

constexpr std::string_view kSiteHead = R"(.\" Written by `rayloc config man site.toml`; do not edit.
.TH SITE.TOML 5 "" "rayloc" "File formats"
.SH NAME
site.toml \- a place where Wi-Fi devices and people are located
.SH SYNOPSIS
.IB SITE /site.toml
.SH DESCRIPTION
A site is a folder with this file, the scene that it names, and what
.B rayloc calibrate
has added.
The file is TOML (https://toml.io).
Relative paths are taken from its folder.
Lengths are metres in the coordinates of the room, z up.
An unknown key, a value of the wrong type or out of range is an error that names line and column.
.P
.B rayloc scene room
and
.B rayloc scene import
write such a folder from a plan, a drawing or a scan,
.B rayloc scene check
.I SITE
reports probable mistakes.
)";

constexpr std::string_view kSiteTail = R"(.SH SEE ALSO
.BR rayloc (1),
.BR raylocd.toml (5),
.BR raylocd (8)
.P
.B rayloc config schema site.toml
prints a JSON schema for editors.
)";

// "from 0 to 3 m"; empty without a limit.
std::string limits(const NumberRange& range) {
  const std::string unit = range.unit.empty() ? "" : " " + std::string(range.unit);
  if (std::isinf(range.max)) {
    return range.unit.empty() ? "" : "in" + unit;
  }
  return "from " + to_text(range.min) + " to " + to_text(range.max) + unit;
}

std::string with_limits(std::string text, const SiteKey& key) {
  const std::string bounds = limits(key.range);
  return text + (bounds.empty() ? "" : ", " + bounds);
}

std::string choices_text(const SiteKey& key) {
  std::string text;
  for (const int number : key.numbers) {
    text += (text.empty() ? "" : ", ") + std::to_string(number);
  }
  for (const std::string_view choice : key.choices) {
    text += (text.empty() ? "\"" : ", \"") + std::string(choice) + "\"";
  }
  return text;
}

std::string value_text(const SiteKey& key) {
  switch (key.type) {
    case SiteType::kBoolean:
      return "true or false";
    case SiteType::kInteger:
      return key.numbers.empty()
                 ? with_limits("a whole number", key)
                 : "one of " + choices_text(key) + " " + std::string(key.range.unit);
    case SiteType::kNumber:
      return with_limits("a number", key);
    case SiteType::kText:
      return "text";
    case SiteType::kChoice:
      return "one of " + choices_text(key);
    case SiteType::kFile:
      return "a file";
    case SiteType::kNumbers:
      return with_limits("an array of " + std::to_string(key.count) + " numbers", key);
    case SiteType::kPairs:
      return with_limits("an array of pairs of numbers, " + std::to_string(key.count) + " at least",
                         key);
    case SiteType::kTable:
    case SiteType::kTables:
    case SiteType::kNamedTables:
      break;
  }
  return "";
}

std::string key_header(const SiteKey& key) {
  const std::string name = table_of(key);
  const std::string line = key.type == SiteType::kTables        ? "[[" + name + "]]"
                           : key.type == SiteType::kNamedTables ? "[" + name + ".NAME]"
                                                                : "[" + name + "]";
  return ".SH \"" + line + "\"\n" + roff(key.description) + ".\n" +
         (key.required ? "Must be there.\n" : "");
}

std::string key_entry(const SiteKey& key) {
  std::string text = ".TP\n.B " + roff(key.key) + "\n" + roff(key.description) + ".\n" +
                     "Value: " + roff(value_text(key)) + ".\n";
  text += key.required ? "Must be stated.\n" : "";
  text += key.with.empty() ? "" : "Together with " + roff(key.with) + " only.\n";
  text += key.without.empty() ? "" : "Not beside " + roff(key.without) + ".\n";
  if (!key.preset.empty()) {
    return text + "Default: " + roff(key.preset) + ".\n";
  }
  return text + "Example: " + roff(key.example) + ".\n";
}

}  // namespace

std::string site_manual_page() {
  std::string page = std::string(kSiteHead) + ".SH TOP OF THE FILE\n";
  for (const SiteKey& key : site_keys()) {
    if (key.table.empty() && !holds_table(key)) {
      page += key_entry(key);
    }
  }
  for (const SiteKey& key : site_keys()) {
    if (holds_table(key)) {
      page += key_header(key);
    } else if (!key.table.empty()) {
      page += key_entry(key);
    }
  }
  return page + std::string(kSiteTail);
}

}  // namespace rayloc
