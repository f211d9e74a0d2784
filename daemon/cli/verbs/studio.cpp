// `rayloc studio SITE`: the map's editor for the folder of a site, without a raylocd.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/live/config/endpoint.h"
#include "daemon/live/config/secrets.h"
#include "daemon/live/http/http_server.h"
#include "daemon/live/http/map_files.h"
#include "daemon/live/studio/pdf_page.h"
#include "daemon/live/studio/studio_routes.h"

namespace rayloc::cli {
namespace {

constexpr auto kStudioTick = std::chrono::milliseconds(100);

struct StudioArguments {
  std::string site;
  std::string listen = "127.0.0.1:8481";
  std::string token_file;
  std::vector<std::string> captures;
};

Expected<HttpServer::Options> server_options(const StudioArguments& arguments) {
  HttpServer::Options options;
  const auto address = parse_listen(arguments.listen);
  if (!address) {
    return make_error(ErrorKind::kUsage,
                      "--listen: '" + arguments.listen + "' " + listen_fault(arguments.listen) +
                          "; write ADDRESS:PORT, as in 127.0.0.1:8481");
  }
  options.host = address->host;
  options.port = address->port;
  if (!arguments.token_file.empty()) {
    auto token = read_http_token(arguments.token_file);
    RAYLOC_TRY(token);
    options.token = *std::move(token);
  }
  if (!is_loopback(options.host) && options.token.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--listen: at " + options.host +
                          " everyone on the network could write the files of the site; write "
                          "127.0.0.1:PORT, or give a --token-file");
  }
  return options;
}

Expected<void> run_studio(const StudioArguments& arguments) {
  const auto options = server_options(arguments);
  RAYLOC_TRY(options);
  std::error_code status;
  std::filesystem::create_directories(arguments.site, status);
  if (!std::filesystem::is_directory(arguments.site, status)) {
    return make_error(ErrorKind::kUsage,
                      arguments.site + ": is no folder; SITE is one, with a site.toml or empty");
  }
  const auto editor = std::make_shared<const SiteEditor>(arguments.site, [] {
    return std::string("saved; a raylocd that runs takes it up when it is reloaded");
  });
  std::map<std::string, HttpRoute> routes = map_routes();
  routes.merge(editor_routes(editor, nullptr, std::make_shared<PdfPage>()));
  routes.merge(beginning_routes(editor, StopSignal::requested));
  std::shared_ptr<CalibrationJob> calibration;
  if (!arguments.captures.empty()) {
    calibration = std::make_shared<CalibrationJob>(
        arguments.site, [captures = arguments.captures](Timestamp /*since*/) { return captures; });
  }
  routes.merge(calibration_routes(calibration));
  routes["/"] = routes.at("/edit");
  auto server = HttpServer::open(*options, std::move(routes));
  RAYLOC_TRY(server);
  StopSignal::install();
  (*server)->start();
  std::fprintf(stderr,
               "http://%s:%u/ is the editor of %s; Ctrl-C ends it\n",
               options->host.c_str(),
               static_cast<unsigned>((*server)->port()),
               arguments.site.c_str());
  while (!StopSignal::requested()) {
    std::this_thread::sleep_for(kStudioTick);
  }
  return {};
}

RunVerb declare_studio(OptionParser& app) {
  const auto arguments = std::make_shared<StudioArguments>();
  app.add_option("SITE", arguments->site, "Folder with a site.toml, or an empty one")->required();
  app.add_option("--listen", arguments->listen, "ADDRESS:PORT of the page; port 0: a free one")
      ->capture_default_str();
  app.add_option("--token-file",
                 arguments->token_file,
                 "File with a token, which a browser gives as the password of user rayloc; needed "
                 "beyond this machine");
  app.add_option("--capture",
                 arguments->captures,
                 "Recordings of the survey in SITE/survey.csv, [AP=]FILE: the page calibrates");
  return [arguments] { return run_studio(*arguments); };
}

}  // namespace

extern const Verb kStudio;
const Verb kStudio = {"studio",
                      "Draw and name a site in a browser: access points, zones, walls, furniture",
                      "rayloc studio office\n"
                      "  rayloc scene import scan.glb --out office && rayloc studio office",
                      declare_studio};

}  // namespace rayloc::cli
