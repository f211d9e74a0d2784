#include "capture/source/transport_schemes.h"
#include "daemon/base/roff.h"
#include "daemon/live/config/config_schema.h"

namespace rayloc {
namespace {

constexpr std::string_view kConfigHead = R"(.\" Written by `rayloc config man`; do not edit.
.TH RAYLOCD.TOML 5 "" "rayloc" "File formats"
.SH NAME
raylocd.toml \- configuration of the Wi-Fi localization daemon raylocd
.SH SYNOPSIS
.I /etc/raylocd/raylocd.toml
.SH DESCRIPTION
The file is TOML (https://toml.io).
Relative paths are taken from the folder of the file that states them.
An unknown key, a value of the wrong type or out of range is an error that names file, line and
column;
.BR raylocd (8)
then ends with exit status 78.
.P
.B systemctl reload raylocd
(SIGHUP) reads the file again, with all that it includes.
When anything in it is wrong nothing changes.
Changes of keys marked
.I reload
apply at once; changes of others are named in the log and wait for a restart.
.P
One
.B [site]
is all that most need.
Several sites are stated as
.BR [[site]] ,
and each
.B [[source]]
names its own.
Each then has topics, paths below /site/NAME/, a folder of its name below those of [record] and of
$STATE_DIRECTORY, and the label site of its metrics.
A reload prepares those sites anew whose keys, sources or files have changed, begins new ones and ends
those that are gone; the others go on as they were, and so does one whose files cannot be used.
)";

constexpr std::string_view kConfigTail = R"(.SH FILES
.TP
.I /etc/raylocd/raylocd.toml
configuration that the unit raylocd.service reads
.SH SEE ALSO
.BR raylocd (8),
.BR rayloc (1)
.P
.B rayloc check\-config
.I FILE
checks a file and the site it names,
.B rayloc config show
.I FILE
prints the settings in effect,
.B rayloc config schema
a JSON schema for editors.
)";

std::string_view type_text(const ConfigOption& option) {
  switch (option.type) {
    case ConfigType::kBoolean:
      return "true or false";
    case ConfigType::kInteger:
      return "a whole number";
    case ConfigType::kNumber:
      return "a number";
    case ConfigType::kText:
      return "text";
    case ConfigType::kChoice:
    case ConfigType::kMethods:
      return "";
    case ConfigType::kFolder:
      return "a folder";
    case ConfigType::kFile:
      return "a file";
    case ConfigType::kFiles:
      return "a file, or an array of files; with wildcards (glob(7))";
    case ConfigType::kSpeed:
      return "\"max\" or a number";
    case ConfigType::kTexts:
      return "an array of texts";
    case ConfigType::kUrl:
      return "a URL";
  }
  return "";
}

// Descriptions of the transports, one below the other.
std::string transports() {
  std::string text = ".RS\n";
  for (const TransportScheme& row : transport_schemes()) {
    if (row.open_source != nullptr) {
      text += ".TP\n.B " + roff(row.example) + "\n" + roff(row.summary) + "\n";
    }
  }
  return text + ".RE\n";
}

std::string option_entry(const ConfigOption& option) {
  std::string values(type_text(option));
  if (const std::string limits = config_limits(option); !limits.empty()) {
    values += (values.empty() ? "" : ", ") + limits;
  }
  std::string text = ".TP\n.B " + roff(option.key) + "\n" + roff(option.description) + ".\n" +
                     "Value: " + roff(values) + ".\n";
  if (option.type == ConfigType::kUrl) {
    text += transports();
  } else if (!option.only_kinds.empty()) {
    text += "Only of kind " + roff(option.only_kinds) + ".\n";
  }
  if (option.required) {
    text += option.in_url ? "Must be stated where there is no url.\n" : "Must be stated.\n";
  }
  if (!option.preset.empty()) {
    text += "Default: " + roff(option.preset) + ".\n";
  } else if (!option.example.empty()) {
    text += "Example: " + roff(option.example) + ".\n";
  }
  return text + (option.reload ? ".I reload\n" : "");
}

}  // namespace

std::string config_manual_page() {
  std::string page(kConfigHead);
  std::string_view section = "none";
  for (const ConfigOption& option : config_options()) {
    if (option.section != section) {
      section = option.section;
      const std::string name(section);
      page += ".SH " +
              (name.empty()       ? "TOP OF THE FILE"
               : name == "source" ? "\"[[source]], once for each access point\""
               : name == "site"   ? "\"[site], or [[site]] once for each of several\""
                                  : "[" + name + "]") +
              "\n";
    }
    page += option_entry(option);
  }
  return page + std::string(kConfigTail);
}

}  // namespace rayloc
