// SiteEditor: the files of a site's folder for the editor in the map: read as a draft, and written
// from one if the result passes the checks of `rayloc scene check`.
//
// A file is replaced in one step; its previous content stays beside it as FILE.bak. Files are
// written only if they still match the draft's origin: concurrent edits are not lost.
//
// Thread safety: one thread at a time.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/live/studio/site_draft.h"
#include "engine/base/expected.h"

namespace rayloc {

class SiteEditor {
 public:
  // Consequence of a saved site for its users: a sentence for people.
  using Saved = std::function<std::string()>;

  explicit SiteEditor(std::filesystem::path directory, Saved saved = {})
      : directory_(std::move(directory)), saved_(std::move(saved)) {}

  const std::filesystem::path& directory() const { return directory_; }
  // True if there is a site.toml.
  bool exists() const;

  // Data for the page: the draft, and "site", "bounds", "plan", "materials", "presets", "problems";
  // {"empty": true} if there is no site.toml.
  Expected<nlohmann::ordered_json> state() const;
  // Saves a draft in JSON; the answer has "said", for people, and "warnings". An Error states the
  // reason, and nothing was written.
  Expected<nlohmann::ordered_json> save(const std::string& draft) const;

 private:
  struct Files {
    std::string toml;
    std::string xml;
    std::filesystem::path scene;  // empty: the site names no existing scene
    std::string revision;
  };

  std::filesystem::path site_file() const { return directory_ / "site.toml"; }
  Expected<Files> read() const;
  Expected<void> replace(const Files& was, const Files& now) const;
  // Returns warnings; an Error if localization is impossible in such a site.
  Expected<std::vector<std::string>> check(const Files& files) const;

  std::filesystem::path directory_;
  Saved saved_;
};

}  // namespace rayloc
