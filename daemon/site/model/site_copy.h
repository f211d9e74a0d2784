// write_site: a self-contained copy of a site: site.toml, scene.xml, meshes/, patterns/, and a
// calibration.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc {

// Checks `directory` as the output of a verb, before any work is done. Errors: it is `input`
// itself, a file, or not empty (unless `force`). `input` may be empty: there is none.
Expected<void> check_output(const std::filesystem::path& directory,
                            const std::filesystem::path& input,
                            bool force);

// Loads the site from which a verb creates another in `output`. An Error if it is not calibrated,
// ending with the reason for needing a calibration (`why`), or as in check_output().
Expected<Site> load_calibrated_site(const std::string& directory,
                                    const std::string& why,
                                    const std::filesystem::path& output,
                                    bool force);

// The same for a site that must not be calibrated yet.
Expected<Site> load_uncalibrated_site(const std::string& directory,
                                      const std::filesystem::path& output,
                                      bool force);

// Creates `directory`. An error if it exists and is not empty, unless `force`: then files of the
// same names are replaced, others stay.
Expected<void> prepare_output(const std::filesystem::path& directory, bool force);

// Writes into `directory`: site.toml as in the original except for the paths in it, the scene with
// every mesh it names, the tables of gains, `site`'s reference if it has one, and `calibration` as
// calibration.toml. Comments of site.toml are not kept. `refined`: content by file name of the
// scene to write instead of the original's, "scene.xml" and the files it names; site.toml then
// states no materials of its own. Empty: the original's scene. Trainings of that calibration are
// copied as training/METHOD.toml.
Expected<void> write_site(const Site& site,
                          const std::string& calibration,
                          const std::filesystem::path& directory,
                          const std::map<std::string, std::string>& refined = {});

Expected<std::string> read_file(const std::filesystem::path& file);

// True if `path` is in that folder or below it, through any links; false if it cannot be
// determined.
bool is_below(const std::filesystem::path& folder, const std::filesystem::path& path);

// Replaces the file in one step: a reader gets the old or the new content.
Expected<void> write_file(const std::filesystem::path& file, const std::string& content);

}  // namespace rayloc
