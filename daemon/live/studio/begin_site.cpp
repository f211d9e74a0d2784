// Creates the first files of a site from a plan or from a drawing of another program.
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/live/studio/child_process.h"
#include "daemon/live/studio/import_process.h"
#include "daemon/live/studio/studio_routes.h"
#include "daemon/site/import/recognise.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/build_room.h"
#include "daemon/site/scene/room_plan.h"
#include "daemon/site/scene/room_site.h"
#include "daemon/site/scene/scene_files.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxPlanBytes = std::size_t{1} << 20U;  // [bytes]
constexpr std::chrono::minutes kMaxImportTime{10};            // chosen, for the largest scans

Expected<void> write_all(const SiteEditor& editor,
                         const std::map<std::string, std::string>& files) {
  if (editor.exists()) {
    return bad_input(editor.directory().string() +
                     ": there is a site here already; begin another one in another folder");
  }
  for (const auto& [name, content] : files) {
    RAYLOC_TRY(write_file(editor.directory() / name, content));
  }
  return {};
}

Expected<Json> begin_room(const SiteEditor& editor, const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || !json.contains("plan") || !json["plan"].is_string()) {
    return bad_input("send {\"plan\": TOML}");
  }
  const auto plan = parse_room_plan(json["plan"].get<std::string>(), "plan");
  RAYLOC_TRY(plan);
  if (!room_pattern_files(*plan).empty()) {
    return bad_input("a plan that is sent cannot name files of antennas");
  }
  auto files = scene_files(build_room(*plan));
  files["site.toml"] = room_site(*plan);
  RAYLOC_TRY(write_all(editor, files));
  return editor.state();
}

// File type from the name sent by the browser; the rest of the name is not used.
std::string kind_of(const HttpParameters& parameters) {
  const auto found = parameters.find("name");
  std::string kind = found == parameters.end() ? "" : fs::path(found->second).extension().string();
  return kind.size() > 1 && kind.size() <= 6 && is_object_name(kind.substr(1)) ? kind : "";
}

Expected<ImportedFiles> import_apart(const fs::path& file,
                                     const SiteEditor& editor,
                                     std::vector<std::string> options,
                                     const std::function<bool()>& is_stopping) {
  const auto program = rayloc_program();
  RAYLOC_TRY(program);
  const std::string name = fs::weakly_canonical(editor.directory()).filename().string();
  if (!name.empty()) {
    options.push_back("--name=" + name);
  }
  return run_import(*program, file, options, kMaxImportTime, is_stopping);
}

Expected<Json> begin_import(const SiteEditor& editor,
                            const HttpParameters& parameters,
                            const std::string& bytes,
                            const std::function<bool()>& is_stopping) {
  const std::string kind = kind_of(parameters);
  if (kind.empty()) {
    return bad_input(std::string("which kind of file is it? Name it as its format is called: ") +
                     kFormats);
  }
  if (editor.exists()) {
    return tl::make_unexpected(write_all(editor, {}).error());
  }
  const fs::path file = editor.directory() / ("import" + kind);
  RAYLOC_TRY(write_file(file, bytes));
  auto imported = import_apart(file, editor, stated_options(parameters), is_stopping);
  if (!imported) {
    std::error_code ignored;
    fs::remove(file, ignored);
    return tl::make_unexpected(std::move(imported.error()));
  }
  RAYLOC_TRY(write_all(editor, imported->files));
  auto state = editor.state();
  if (state) {
    (*state)["said"] = imported->remarks;
  }
  return state;
}

}  // namespace

std::map<std::string, HttpRoute> beginning_routes(const std::shared_ptr<const SiteEditor>& editor,
                                                  const std::function<bool()>& is_stopping) {
  std::map<std::string, HttpRoute> routes;
  HttpRoute& room = routes["/api/v1/edit/room"];
  room.method = "POST";
  room.receive = [editor](const HttpParameters&, const std::string& body) {
    return editor_reply(begin_room(*editor, body));
  };
  room.most_bytes = kMaxPlanBytes;
  HttpRoute& upload = routes["/api/v1/edit/import"];
  upload.method = "POST";
  upload.receive = [editor, is_stopping](const HttpParameters& parameters,
                                         const std::string& body) {
    return editor_reply(begin_import(*editor, parameters, body, is_stopping));
  };
  upload.content_type = "application/octet-stream";
  upload.most_bytes = kLargestImport;
  return routes;
}

}  // namespace rayloc
