#include "daemon/site/scene/scene_source.h"

#include <system_error>
#include <utility>

#include "daemon/site/model/room_model.h"
#include "engine/scene/read/load_scene.h"

namespace rayloc {

Expected<SceneSource> load_scene_source(const std::filesystem::path& path,
                                        std::optional<double> frequency_hz) {
  SceneSource source;
  SceneOptions options;
  options.carrier_hz = kDefaultFrequency;
  std::error_code status;
  if (std::filesystem::is_directory(path, status) || path.extension() == ".toml") {
    auto site = load_site(path);
    RAYLOC_TRY(site);
    options = scene_options(*site);
    source.name = site->name;
    source.file = site->scene_file;
    source.site = *std::move(site);
  } else {
    const std::filesystem::path folder = std::filesystem::absolute(path, status).parent_path();
    source.name = (path.stem() == "scene" ? folder.filename() : path.stem()).string();
    source.file = path;
  }
  options.carrier_hz = frequency_hz.value_or(options.carrier_hz);
  auto scene = load_scene(source.file, options);
  RAYLOC_TRY(scene);
  source.scene = std::make_shared<const Scene>(*std::move(scene));
  return source;
}

}  // namespace rayloc
