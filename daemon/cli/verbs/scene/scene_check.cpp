// `rayloc scene check`: prints the contents of a scene and its probable errors.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/scene/scene_verbs.h"
#include "daemon/site/scene/scene_report.h"
#include "daemon/site/scene/scene_report_text.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

struct SceneCheckArguments {
  std::string scene;
  std::optional<double> frequency;
  bool json = false;
};

Expected<void> run_scene_check(const SceneCheckArguments& arguments) {
  const Expected<SceneSource> source = load_scene_source(arguments.scene, arguments.frequency);
  if (!source) {
    return report_file_error(source.error());
  }
  const SceneReport report = inspect_scene(*source);
  const std::string text =
      arguments.json ? scene_report_json(*source, report) : scene_report_text(*source, report);
  std::fputs(printable(text, '\n').c_str(), stdout);
  std::string errors;
  for (const SceneWarning& error : report.errors) {
    errors += (errors.empty() ? "" : "\n") + source->file.string() + ": " + error.message;
  }
  return errors.empty() ? Expected<void>()
                        : report_file_error({ErrorKind::kConfiguration, std::move(errors)});
}

}  // namespace

RunVerb declare_scene_check(OptionParser& app) {
  const auto arguments = std::make_shared<SceneCheckArguments>();
  app.add_option("SCENE", arguments->scene, "Mitsuba XML, or a site: a directory with site.toml")
      ->required();
  app.add_option("--frequency",
                 arguments->frequency,
                 "Carrier of the materials [Hz]; default: the site's, else 5.18e9");
  app.add_flag("--json", arguments->json, "One JSON object");
  app.footer(
      "Example:\n  rayloc scene check tests/data/sites/meeting_room\n"
      "  rayloc scene check office/scene.xml --frequency 2.437e9 --json");
  return [arguments] { return run_scene_check(*arguments); };
}

}  // namespace rayloc::cli
