// `rayloc config default|schema|man|show FILE`: documents
// raylocd's configuration and the keys of a site.
#include <cstdio>
#include <memory>
#include <string>

#include "daemon/cli/command/file_error.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/live/config/config_schema.h"
#include "daemon/live/config/site_reference.h"

namespace rayloc::cli {
namespace {

Expected<void> print(const Expected<std::string>& text) {
  if (!text) {
    return report_file_error(text.error());
  }
  std::fputs(text->c_str(), stdout);
  return {};
}

RunVerb declare_config(OptionParser& app) {
  const auto file = std::make_shared<std::string>();
  const auto of = std::make_shared<std::string>("raylocd.toml");
  const OptionParser* example = app.add_subcommand(
      "default", "Print every key with its default and what it means, as a file to start from");
  OptionParser* schema = app.add_subcommand("schema", "Print a JSON schema, for editors");
  OptionParser* manual =
      app.add_subcommand("man", "Print the manual page raylocd.toml(5) or site.toml(5)");
  for (OptionParser* printed : {schema, manual}) {
    printed->add_option("OF", *of, "raylocd.toml or site.toml")
        ->check(one_of({"raylocd.toml", "site.toml"}))
        ->capture_default_str();
  }
  OptionParser* show = app.add_subcommand("show", "Print the values that hold with a file");
  show->add_option("FILE", *file, "raylocd.toml")->required();
  app.require_subcommand(1);
  return [file, of, example, schema, manual] {
    const bool is_site = *of == "site.toml";
    if (example->parsed()) {
      return print(config_example());
    }
    if (manual->parsed()) {
      return print(is_site ? site_manual_page() : config_manual_page());
    }
    if (schema->parsed()) {
      return print(is_site ? site_json_schema() : config_json_schema());
    }
    return print(effective_config(*file));
  };
}

}  // namespace

extern const Verb kConfig;
const Verb kConfig = {
    "config",
    "Print the configuration of raylocd: defaults, in effect, schema; keys of site.toml",
    "rayloc config default > raylocd.toml",
    declare_config};

}  // namespace rayloc::cli
