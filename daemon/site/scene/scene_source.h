// load_scene_source: loads the SCENE argument of verbs: a Mitsuba XML, or a site (a directory with
// site.toml, or that file), whose scene is read with the site's carrier and materials.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/scene/scene.h"

namespace rayloc {

// The carrier of a scene without a site: 5.18 GHz, channel 36.
inline constexpr double kDefaultFrequency = 5.18e9;  // [Hz]

struct SceneSource {
  std::string name;            // name of the site, else of the file, or of a "scene.xml"'s folder
  std::filesystem::path file;  // the XML
  std::shared_ptr<const Scene> scene;
  std::optional<Site> site;
};

// `frequency_hz` replaces the site's carrier. Errors name file:line:column.
Expected<SceneSource> load_scene_source(const std::filesystem::path& path,
                                        std::optional<double> frequency_hz);

}  // namespace rayloc
