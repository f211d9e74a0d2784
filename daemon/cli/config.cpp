// `rayloc config default|schema|man|show FILE`: raylocd's configuration in words.
#include <cstdio>
#include <memory>
#include <string>

#include "daemon/cli/verbs.h"
#include "daemon/command/file_error.h"
#include "daemon/command/verb.h"
#include "daemon/config/config_schema.h"

namespace rayloc::cli {
namespace {

Expected<void> print(const Expected<std::string>& text) {
  if (!text) {
    return report_file_error(text.error());
  }
  std::fputs(text->c_str(), stdout);
  return {};
}

RunVerb declare(OptionParser& app) {
  const auto file = std::make_shared<std::string>();
  const OptionParser* example = app.add_subcommand(
      "default", "Print every key with its default and what it means, as a file to start from");
  const OptionParser* schema = app.add_subcommand("schema", "Print a JSON schema, for editors");
  const OptionParser* manual = app.add_subcommand("man", "Print the manual page raylocd.toml(5)");
  OptionParser* show = app.add_subcommand("show", "Print the values that hold with a file");
  show->add_option("FILE", *file, "raylocd.toml")->required();
  app.require_subcommand(1);
  return [file, example, schema, manual] {
    if (example->parsed()) {
      return print(config_example());
    }
    if (manual->parsed()) {
      return print(config_manual_page());
    }
    return print(schema->parsed() ? config_json_schema() : effective_config(*file));
  };
}

}  // namespace

extern const Verb kConfig;
const Verb kConfig = {"config",
                      "Print the configuration of raylocd: defaults, in effect, schema",
                      "rayloc config default > raylocd.toml",
                      declare};

}  // namespace rayloc::cli
