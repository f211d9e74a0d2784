#include "daemon/live/service/site/input_files.h"

#include <algorithm>

#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "engine/base/content_hash.h"
#include "engine/scene/read/load_scene.h"

namespace rayloc {
namespace {

// Empty for an unreadable file, which thereby differs from a readable one.
std::string hash_of(const Expected<std::string>& content) {
  if (!content) {
    return "";
  }
  ContentHash hash;
  hash.add(*content);
  return hash.text();
}

}  // namespace

InputFiles InputFiles::of(const DaemonSetup& setup) {
  InputFiles files;
  if (!setup.config.has_site_list) {
    files.add_site(setup.sites.front().site);
  }
  const DaemonConfig& config = setup.config;
  for (const auto& secret :
       {config.curve.secret_file, config.http.token_file, config.privacy.key_file}) {
    if (!secret.empty()) {
      files.add(secret);
    }
  }
  return files;
}

InputFiles InputFiles::of(const SiteSetup& setup) {
  InputFiles files;
  files.add_site(setup.site);
  return files;
}

void InputFiles::add_site(const Site& site) {
  for (const std::filesystem::path& file : site.files) {
    add(file);
  }
  add_scene(site);
}

void InputFiles::add(const std::filesystem::path& file) {
  hash_[file.string()] = hash_of(read_file(file));
}

// The meshes that the scene names. The code that loads the scene validates it.
void InputFiles::add_scene(const Site& site) {
  const Expected<std::string> xml = read_file(site.scene_file);
  if (!xml) {
    return;
  }
  const std::filesystem::path folder = site.scene_file.parent_path();
  static_cast<void>(parse_scene(
      *xml, site.scene_file.string(), scene_options(site), [&](const std::string& name) {
        const std::filesystem::path mesh = folder / name;
        Expected<std::string> content = read_file(mesh);
        hash_[mesh.string()] = hash_of(content);
        return content;
      }));
}

std::vector<std::string> InputFiles::changes_to(const InputFiles& newer) const {
  std::vector<std::string> changed;
  for (const auto& [file, hash] : hash_) {
    const auto now = newer.hash_.find(file);
    if (now == newer.hash_.end() || now->second != hash) {
      changed.push_back(file);
    }
  }
  for (const auto& [file, hash] : newer.hash_) {
    if (hash_.count(file) == 0) {
      changed.push_back(file);
    }
  }
  std::sort(changed.begin(), changed.end());
  return changed;
}

}  // namespace rayloc
