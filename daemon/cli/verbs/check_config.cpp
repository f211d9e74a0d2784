// `rayloc check-config FILE`: checks that raylocd would start with the file. Errors go to stderr,
// one per line, as FILE:LINE:COLUMN: message; the exit status is 78 if there are any.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <system_error>

#include "daemon/cli/arguments/scene_notes.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/arguments/site_check.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/live/config/config.h"
#include "daemon/live/config/secrets.h"
#include "daemon/live/health/readiness.h"
#include "daemon/site/model/room_match.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_lacks.h"

namespace rayloc::cli {
namespace {

struct CheckConfigArguments {
  std::string path;
  bool quiet = false;
};

std::string quantity_text(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string describe(const Site& site) {
  return "site '" + site.name + "', " +
         quantity_text(site.access_points.size(), "access point", "access points");
}

using LacksOf = std::function<SiteLacks(const RoomModel& room)>;

// Reads the scene and the calibration as raylocd will read them.
Expected<std::string> check_room(const Site& site, const LacksOf& lacks_of) {
  const Expected<RoomModel> room = load_room_model(site);
  RAYLOC_TRY(room);
  print_scene_notes(*room->scene);
  for (const std::string& warning : room_warnings(*room->scene, site)) {
    std::fprintf(stderr, "%s\n", warning.c_str());
  }
  for (const std::string& lack : lacks_of(*room).all()) {
    std::fprintf(stderr, "%s: %s\n", (site.directory / "site.toml").c_str(), lack.c_str());
  }
  return describe(site) + (room->calibration_id.empty() ? ", not calibrated" : ", calibrated");
}

// Root can read every file; the user that systemd
// creates for raylocd.service cannot read root's files.
void warn_of_files_of_root(const DaemonConfig& config) {
  const auto warn = [](const std::filesystem::path& file, const char* key, const char* credential) {
    struct stat status {};
    if (geteuid() == 0 && !file.empty() && stat(file.c_str(), &status) == 0 && status.st_uid == 0 &&
        (status.st_mode & S_IROTH) == 0) {
      std::fprintf(stderr,
                   "%s: warning: raylocd.service cannot read what is root's alone; leave %s out, "
                   "and let systemd pass the credential %s (its drop-in)\n",
                   file.c_str(),
                   key,
                   credential);
    }
  };
  warn(config.http.token_file, "[http] token_file", "http.token");
  warn(config.privacy.key_file, "[privacy] key_file", "privacy.key");
  warn(config.curve.secret_file, "[curve] secret_file", "curve.secret");
}

Expected<void> check_secrets_of(const DaemonConfig& config) {
  // The process with the credentials runs as the service's user.
  if (std::getenv("CREDENTIALS_DIRECTORY") == nullptr) {
    warn_of_files_of_root(config);
  }
  return check_secrets(config);
}

Expected<std::string> check_daemon(const std::filesystem::path& path) {
  std::error_code status;
  if (std::filesystem::is_directory(path, status) || path.filename() == "site.toml") {
    return check_site(path);
  }
  const Expected<DaemonSetup> setup = load_daemon_setup(path);
  RAYLOC_TRY(setup);
  RAYLOC_TRY(check_secrets_of(setup->config));
  std::string good;
  for (const SiteSetup& site : setup->sites) {
    Expected<std::string> room =
        check_room(site.site, [&](const RoomModel& read) { return lacks_of(site, read); });
    if (!room) {
      return room;
    }
    good += (good.empty() ? "" : "; ") + *room;
  }
  return good + ", " + quantity_text(setup->config.sources.size(), "source", "sources");
}

Expected<void> run_check_config(const CheckConfigArguments& arguments) {
  const Expected<std::string> found = check_daemon(arguments.path);
  if (!found) {
    return report_file_error({ErrorKind::kConfiguration, found.error().message});
  }
  if (!arguments.quiet) {
    std::fprintf(stderr, "%s: good: %s\n", arguments.path.c_str(), found->c_str());
  }
  return {};
}

RunVerb declare_check_config(OptionParser& app) {
  const auto arguments = std::make_shared<CheckConfigArguments>();
  app.add_option("FILE", arguments->path, "raylocd.toml, or a site: a directory with site.toml")
      ->required();
  app.add_flag("--quiet", arguments->quiet, "Print nothing when all is well");
  return [arguments] { return run_check_config(*arguments); };
}

}  // namespace

Expected<std::string> check_site(const std::filesystem::path& folder) {
  const Expected<Site> site = load_site(folder);
  RAYLOC_TRY(site);
  return check_room(*site, [&](const RoomModel& read) { return site_lacks(*site, read); });
}

extern const Verb kCheckConfig;
const Verb kCheckConfig = {"check-config",
                           "Check a configuration of raylocd and its site",
                           "rayloc check-config /etc/raylocd/raylocd.toml",
                           declare_check_config};

}  // namespace rayloc::cli
