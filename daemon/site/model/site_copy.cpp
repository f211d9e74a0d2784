#include "daemon/site/model/site_copy.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>
#include <utility>

#include <toml++/toml.h>

#include "daemon/site/model/room_model.h"
#include "engine/scene/read/load_scene.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> cannot(const std::string& what,
                             const fs::path& file,
                             const std::string& why) {
  return make_error(ErrorKind::kUnavailable, file.string() + ": cannot be " + what + ": " + why);
}

// Gives each table of gains its own name in the copy; returns their contents by that name.
Expected<std::map<std::string, std::string>> take_patterns(toml::table& root,
                                                           const fs::path& directory) {
  std::map<std::string, std::string> patterns;
  for (const std::string kind : {"access_point", "transmitter"}) {
    const toml::array* tables = root[kind].as_array();
    for (std::size_t i = 0; tables != nullptr && i < tables->size(); ++i) {
      const auto stated = root[kind][i]["pattern_file"];
      if (const auto file = stated.value<std::string>()) {
        auto content = read_file(directory / *file);
        RAYLOC_TRY(content);
        const std::string name = "patterns/" + kind + "-" + std::to_string(i + 1) + ".csv";
        *stated.as_string() = name;
        patterns[name] = *std::move(content);
      }
    }
  }
  return patterns;
}

struct SiteFiles {
  std::string toml;
  std::map<std::string, std::string> others;  // content by file, relative to the copy
};

// Trainings made with this calibration, as text; those of another one are not usable.
Expected<std::map<std::string, std::string>> take_trainings(const Site& site,
                                                            const std::string& calibration,
                                                            toml::table& root) {
  std::map<std::string, std::string> files;
  toml::array tables;
  for (const auto& [method, file] : site.training_files) {
    auto content = read_file(file);
    RAYLOC_TRY(content);
    const auto made_with = toml::parse(*content, file.string())["calibration"].value<std::string>();
    if (made_with && made_with == toml::parse(calibration)["id"].value<std::string>()) {
      const std::string name = "training/" + method + ".toml";
      if (const auto weights =
              toml::parse(*content, file.string())["network"]["weights"].value<std::string>()) {
        auto bytes = read_file(file.parent_path() / *weights);
        RAYLOC_TRY(bytes);
        files["training/" + *weights] = *std::move(bytes);
      }
      tables.push_back(toml::table{{"method", method}, {"file", name}});
      files[name] = *std::move(content);
    }
  }
  root.erase("training");
  if (!tables.empty()) {
    root.insert_or_assign("training", std::move(tables));
  }
  return files;
}

// The original's text with the paths that the copy needs, the tables of gains and the trainings.
Expected<SiteFiles> read_site(const Site& site,
                              const std::string& calibration,
                              bool own_materials) {
  const fs::path file = site.directory / "site.toml";
  auto text = read_file(file);
  RAYLOC_TRY(text);
  try {
    toml::table root = toml::parse(*text, file.string());
    root.insert_or_assign("scene", "scene.xml");
    if (!own_materials) {
      root.erase("materials");
    }
    root.insert_or_assign("calibration", toml::table{{"file", "calibration.toml"}});
    if (site.reference_file) {
      root.insert_or_assign("reference", toml::table{{"file", "reference.toml"}});
    } else {
      root.erase("reference");
    }
    auto patterns = take_patterns(root, site.directory);
    RAYLOC_TRY(patterns);
    auto others = take_trainings(site, calibration, root);
    RAYLOC_TRY(others);
    others->merge(*patterns);
    std::ostringstream out;
    out << "# A calibrated copy of " << file.string() << "\n" << root << "\n";
    return SiteFiles{out.str(), *std::move(others)};
  } catch (const toml::parse_error& error) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": " + std::string(error.description()));
  }
}

struct SceneFiles {
  std::string xml;
  std::map<std::string, std::string> meshes;  // content by file, relative to the copy
};

bool is_outside(const fs::path& path) {  // true if not in the scene's folder
  const fs::path normal = path.lexically_normal();
  return path.is_absolute() || (!normal.empty() && *normal.begin() == fs::path(".."));
}

// Changes the name of a mesh wherever it is a value; false if it is not found as written.
bool rename_mesh(std::string& xml, const std::string& name, const std::string& own) {
  bool found = false;
  std::string of_windows = name;
  std::replace(of_windows.begin(), of_windows.end(), '/', '\\');
  for (const std::string& written : {name, of_windows}) {
    for (const char* quote : {"\"", "'"}) {
      for (std::size_t at = 0; (at = xml.find(quote + written + quote, at)) != std::string::npos;
           at += own.size()) {
        xml.replace(at + 1, written.size(), own);
        found = true;
      }
    }
  }
  return found;
}

// The scene as text, with every mesh it names; names that leave the folder are changed.
Expected<SceneFiles> read_scene(const Site& site) {
  auto xml = read_file(site.scene_file);
  RAYLOC_TRY(xml);
  SceneFiles files;
  std::map<std::string, std::string> renamed;
  const auto parsed = parse_scene(
      *xml,
      site.scene_file.string(),
      scene_options(site),
      [&](const std::string& name) -> Expected<std::string> {
        const fs::path path(name);
        auto content = read_file(path.is_absolute() ? path : site.scene_file.parent_path() / path);
        if (content) {
          const std::string own = is_outside(path) ? "meshes/" + path.filename().string()
                                                   : path.lexically_normal().generic_string();
          const auto [known, added] = files.meshes.emplace(own, *content);
          if (!added && known->second != *content) {
            return bad_input(site.scene_file.string() + ": two meshes are called " + own +
                             "; rename one");
          }
          if (own != name) {
            renamed[name] = own;
          }
        }
        return content;
      });
  RAYLOC_TRY(parsed);
  for (const auto& [name, own] : renamed) {
    if (!rename_mesh(*xml, name, own) && is_outside(name)) {
      return bad_input(
          site.scene_file.string() + ": the mesh " + name +
          " lies outside of the scene's folder, and the copy cannot name it otherwise; "
          "write its name out, or move it into the folder");
    }
  }
  files.xml = *std::move(xml);
  return files;
}

}  // namespace

Expected<std::string> read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  if (!in) {
    return cannot("read", file, "is it there, and may you read it?");
  }
  return content.str();
}

Expected<void> check_output(const fs::path& directory, const fs::path& input, bool force) {
  std::error_code status;
  if (!fs::exists(directory, status)) {
    return {};
  }
  if (!fs::is_directory(directory, status)) {
    return make_error(ErrorKind::kUsage, directory.string() + " is a file; --out names a folder");
  }
  if (!input.empty() && fs::equivalent(directory, input, status)) {
    return make_error(ErrorKind::kUsage,
                      directory.string() +
                          " is the site that is read, and no verb changes its "
                          "inputs; choose another --out");
  }
  if (!fs::is_empty(directory, status) && !force) {
    return make_error(ErrorKind::kUsage,
                      directory.string() + " is not empty; choose another --out, or --force");
  }
  return {};
}

Expected<Site> load_calibrated_site(const std::string& directory,
                                    const std::string& why,
                                    const fs::path& output,
                                    bool force) {
  auto site = load_site(directory);
  if (!site) {
    return site;
  }
  if (!site->calibration_file) {
    return make_error(ErrorKind::kConfiguration, directory + ": is not calibrated" + why);
  }
  RAYLOC_TRY(check_output(output, site->directory, force));
  return site;
}

Expected<Site> load_uncalibrated_site(const std::string& directory,
                                      const fs::path& output,
                                      bool force) {
  auto site = load_site(directory);
  if (!site) {
    return site;
  }
  if (site->calibration_file) {
    return make_error(ErrorKind::kConfiguration, directory + ": is calibrated already");
  }
  RAYLOC_TRY(check_output(output, site->directory, force));
  return site;
}

Expected<void> prepare_output(const fs::path& directory, bool force) {
  RAYLOC_TRY(check_output(directory, {}, force));
  std::error_code status;
  fs::create_directories(directory, status);
  if (status) {
    return cannot("created", directory, status.message());
  }
  return {};
}

bool is_below(const fs::path& folder, const fs::path& path) {
  std::error_code failed;
  const fs::path whole = fs::weakly_canonical(folder, failed);
  const fs::path inner = failed ? fs::path() : fs::weakly_canonical(path, failed);
  return !failed &&
         std::mismatch(whole.begin(), whole.end(), inner.begin(), inner.end()).first == whole.end();
}

Expected<void> write_file(const fs::path& file, const std::string& content) {
  std::error_code status;
  fs::create_directories(file.parent_path(), status);
  const fs::path partial = file.string() + ".partial";
  {
    std::ofstream out(partial, std::ios::binary);
    out << content;
    out.flush();
    if (!out) {
      return cannot("written", partial, "is the disk full?");
    }
  }
  fs::rename(partial, file, status);
  if (status) {
    return cannot("written", file, status.message());
  }
  return {};
}

Expected<void> write_site(const Site& site,
                          const std::string& calibration,
                          const fs::path& directory,
                          const std::map<std::string, std::string>& refined) {
  auto stated = read_site(site, calibration, refined.empty());
  RAYLOC_TRY(stated);
  std::map<std::string, std::string> files = refined;
  if (refined.empty()) {
    auto scene = read_scene(site);
    RAYLOC_TRY(scene);
    files = std::move(scene->meshes);
    files["scene.xml"] = std::move(scene->xml);
  }
  files["site.toml"] = std::move(stated->toml);
  files["calibration.toml"] = calibration;
  files.merge(stated->others);
  if (site.reference_file) {
    auto reference = read_file(*site.reference_file);
    RAYLOC_TRY(reference);
    files["reference.toml"] = *std::move(reference);
  }
  for (const auto& [name, content] : files) {
    RAYLOC_TRY(write_file(directory / name, content));
  }
  return {};
}

}  // namespace rayloc
