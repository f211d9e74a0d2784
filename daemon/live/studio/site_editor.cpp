#include "daemon/live/studio/site_editor.h"

#include <algorithm>
#include <memory>
#include <system_error>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/live/live_map/map_geometry.h"
#include "daemon/live/studio/scene_text.h"
#include "daemon/live/studio/site_text.h"
#include "daemon/live/studio/toml_text.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/access_point_presets.h"
#include "daemon/site/scene/scene_report.h"
#include "daemon/site/scene/scene_source.h"
#include "engine/base/content_hash.h"
#include "engine/em/radio_material.h"
#include "engine/scene/read/load_scene.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json presets_json() {
  Json list = Json::array();
  for (const AntennaPreset& preset : kAntennaPresets) {
    Json antennas = Json::array();
    for (std::size_t i = 0; i < preset.rx_chains.size(); ++i) {
      antennas.push_back(
          {{"core", preset.rx_chains.at(i)},
           {"offset", {0.0, preset.spacing_m * (static_cast<double>(i) - 1.0), 0.0}}});
    }
    list.push_back(
        {{"model", preset.model}, {"remark", preset.remark}, {"antennas", std::move(antennas)}});
  }
  return list;
}

Json materials_json(const std::string& xml) {
  Json list = Json::array();
  for (const std::string& name : scene_materials(xml)) {
    list.push_back({{"name", name}, {"there", true}});
  }
  for (const std::string& name : itu_material_names()) {
    list.push_back({{"name", name}, {"there", false}});
  }
  return list;
}

// Meshes are read from the scene's folder.
Expected<Scene> scene_of(const std::string& xml,
                         const fs::path& file,
                         const SceneOptions& options) {
  return parse_scene(xml, file.string(), options, [&](const std::string& name) {
    return read_file(file.parent_path() / name);
  });
}

void draw(const Scene& scene, Json& state) {
  const Vec3d& low = scene.bounds_min();
  const Vec3d& high = scene.bounds_max();
  state["bounds"] = {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}};
  state["plan"] = Json::parse(map_plan_json(scene), nullptr, false);
}

}  // namespace

bool SiteEditor::exists() const {
  std::error_code status;
  return fs::exists(site_file(), status);
}

Expected<SiteEditor::Files> SiteEditor::read() const {
  std::error_code status;
  if (fs::is_symlink(site_file(), status)) {
    return bad_input(site_file().string() + ": is a link; edit the folder that it leads to");
  }
  Files files;
  auto toml = read_file(site_file());
  RAYLOC_TRY(toml);
  files.toml = *std::move(toml);
  const auto parsed = TomlText::parse(files.toml, site_file());
  RAYLOC_TRY(parsed);
  const std::string stated = parsed->root()["scene"].value_or<std::string>("");
  const fs::path scene = directory_ / stated;
  if (!stated.empty() && fs::is_regular_file(scene, status)) {
    auto xml = read_file(scene);
    RAYLOC_TRY(xml);
    files.scene = scene;
    files.xml = *std::move(xml);
  }
  ContentHash hash;
  hash.add(files.toml);
  hash.add(files.xml);
  files.revision = hash.text();
  return files;
}

Expected<std::vector<std::string>> SiteEditor::check(const Files& files) const {
  auto site = parse_site(files.toml, site_file());
  RAYLOC_TRY(site);
  auto scene = scene_of(files.xml, files.scene, scene_options(*site));
  RAYLOC_TRY(scene);
  const auto shared = std::make_shared<const Scene>(*std::move(scene));
  if (const auto room = room_model_of(*site, shared); !room) {
    return make_error(
        room.error().kind,
        room.error().message +
            (site->calibration_file
                 ? "\nThis folder holds a calibration. Draw in the one that it was made "
                   "from, and calibrate again"
                 : ""));
  }
  std::vector<std::string> warnings =
      zone_warnings(*site, shared->bounds_min(), shared->bounds_max());
  const SceneSource source{site->name, files.scene, shared, *std::move(site)};
  const SceneReport report = inspect_scene(source);
  std::string errors;
  for (const SceneWarning& error : report.errors) {
    errors += (errors.empty() ? "" : "\n") + error.message;
  }
  if (!errors.empty()) {
    return make_error(ErrorKind::kConfiguration, std::move(errors));
  }
  for (const SceneWarning& warning : report.warnings) {
    warnings.push_back(warning.message);
  }
  return warnings;
}

Expected<Json> SiteEditor::state() const {
  if (!exists()) {
    return Json{{"empty", true}, {"folder", directory_.string()}, {"presets", presets_json()}};
  }
  const auto files = read();
  RAYLOC_TRY(files);
  auto draft = read_site_text(files->toml, site_file());
  RAYLOC_TRY(draft);
  const auto parsed = TomlText::parse(files->toml, site_file());
  draft->revision = files->revision;
  Json state = {{"empty", false},
                {"folder", directory_.string()},
                {"site", parsed->root()["name"].value_or<std::string>("")},
                {"calibrated", parsed->root().contains("calibration")},
                {"presets", presets_json()},
                {"materials", materials_json(files->xml)},
                {"problems", Json::array()}};
  if (auto objects = read_scene_text(files->xml, files->scene.string())) {
    draft->objects = *std::move(objects);
  }
  // An incomplete site is drawn, too.
  SceneOptions options;
  options.carrier_hz = kDefaultFrequency;
  if (const auto site = parse_site(files->toml, site_file())) {
    options = scene_options(*site);
  }
  if (const auto scene = scene_of(files->xml, files->scene, options)) {
    draw(*scene, state);
  }
  if (const auto checked = check(*files); !checked) {
    state["problems"].push_back(checked.error().message);
  } else {
    state["problems"] = *checked;
  }
  state["draft"] = json_of(*draft);
  return state;
}

Expected<Json> SiteEditor::save(const std::string& text) const {
  const auto draft = parse_draft(text);
  RAYLOC_TRY(draft);
  const auto was = read();
  RAYLOC_TRY(was);
  if (draft->revision != was->revision) {
    return make_error(ErrorKind::kUnavailable,
                      "the files of the site have changed since they were read here; your drawing "
                      "is kept: write down what you need of it, then read them again");
  }
  Files now = *was;
  auto toml = edit_site_text(was->toml, site_file(), *draft);
  RAYLOC_TRY(toml);
  now.toml = *std::move(toml);
  auto xml = edit_scene_text(was->xml, was->scene.string(), draft->objects);
  RAYLOC_TRY(xml);
  now.xml = *std::move(xml);
  const auto warnings = check(now);
  RAYLOC_TRY(warnings);
  const bool changed = now.toml != was->toml || now.xml != was->xml;
  // The check of a large scene takes seconds.
  if (const auto meanwhile = read(); !meanwhile || meanwhile->revision != was->revision) {
    return make_error(ErrorKind::kUnavailable,
                      "the files of the site have changed while this was checked; your drawing is "
                      "kept: read them again");
  }
  RAYLOC_TRY(replace(*was, now));
  return Json{{"said",
               !changed ? "nothing has changed"
               : saved_ ? saved_()
                        : "saved"},
              {"warnings", *warnings}};
}

Expected<void> SiteEditor::replace(const Files& was, const Files& now) const {
  std::error_code status;
  if (now.xml != was.xml) {
    if (!is_below(directory_, was.scene) || fs::is_symlink(was.scene, status)) {
      return bad_input(was.scene.string() +
                       ": is not in the folder of the site, which is all that is written here; "
                       "copy it there, with its meshes");
    }
  }
  // Writes the backups first, so that they exist if a later step fails.
  const auto write = [](const fs::path& file, const std::string& old, const std::string& text) {
    if (old == text) {
      return Expected<void>();
    }
    auto kept = write_file(file.string() + ".bak", old);
    return kept ? write_file(file, text) : kept;
  };
  RAYLOC_TRY(write(was.scene, was.xml, now.xml));
  auto toml = write(site_file(), was.toml, now.toml);
  if (!toml && now.xml != was.xml) {
    static_cast<void>(write_file(was.scene, was.xml));
  }
  return toml;
}

}  // namespace rayloc
