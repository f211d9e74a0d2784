// SiteEditor: the files of a site's folder for the editor in the map: read as a draft, and written
// from one when what it would be passes the checks of `rayloc scene check`.
//
// A file is replaced in one step; what it was stays beside it as FILE.bak. Files are written only
// if they are what the draft was made from: who edits them meanwhile loses nothing.
//
// Thread safety: one thread at a time.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/studio/site_draft.h"
#include "engine/base/expected.h"

namespace rayloc {

class SiteEditor {
 public:
  // What a saved site means for whoever works with it: a sentence for people.
  using Saved = std::function<std::string()>;

  explicit SiteEditor(std::filesystem::path directory, Saved saved = {})
      : directory_(std::move(directory)), saved_(std::move(saved)) {}

  const std::filesystem::path& directory() const { return directory_; }
  // Whether there is a site.toml.
  bool exists() const;

  // What the editor draws: the draft, and "site", "bounds", "plan", "materials", "presets",
  // "problems"; {"empty": true} where there is no site.toml.
  Expected<nlohmann::ordered_json> state() const;
  // Of a draft as JSON; the answer has "said", for people, and "warnings". An Error says what is
  // wrong, and nothing was written.
  Expected<nlohmann::ordered_json> save(const std::string& draft) const;

 private:
  struct Files {
    std::string toml;
    std::string xml;
    std::filesystem::path scene;  // empty: the site states none that is there
    std::string revision;
  };

  std::filesystem::path site_file() const { return directory_ / "site.toml"; }
  Expected<Files> read() const;
  Expected<void> replace(const Files& was, const Files& now) const;
  // Warnings; an Error where nothing could be located in such a site.
  Expected<std::vector<std::string>> check(const Files& files) const;

  std::filesystem::path directory_;
  Saved saved_;
};

}  // namespace rayloc
