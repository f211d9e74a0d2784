// write_site: a copy of a site that stands on its own: site.toml, scene.xml, meshes/, patterns/,
// and a calibration.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "daemon/site/site.h"
#include "engine/base/expected.h"

namespace rayloc {

// What is wrong with `directory` as the output of a verb, before any work is done: it is `input`
// itself, a file, or not empty (unless `force`). `input` may be empty: there is none.
Expected<void> check_output(const std::filesystem::path& directory,
                            const std::filesystem::path& input,
                            bool force);

// The site that a verb makes another one of, in `output`. An Error where it is not calibrated,
// which ends with what calibration is needed for (`why`), and as of check_output().
Expected<Site> load_calibrated_site(const std::string& directory,
                                    const std::string& why,
                                    const std::filesystem::path& output,
                                    bool force);

// The same of a site that must not be calibrated yet.
Expected<Site> load_uncalibrated_site(const std::string& directory,
                                      const std::filesystem::path& output,
                                      bool force);

// Creates `directory`. An error when it exists and is not empty, unless `force`: then files of the
// same names are replaced, others stay.
Expected<void> prepare_output(const std::filesystem::path& directory, bool force);

// Writes into `directory`: site.toml as the original states it but for the paths in it,
// the scene with every mesh it names, the tables of gains, `site`'s reference if it has one, and
// `calibration` as calibration.toml. Comments of site.toml are not kept.
// `refined`: content by file name of the scene to write instead of the original's, "scene.xml" and
// what it names; site.toml then states no materials of its own. Empty: the original's scene.
// What was trained goes with it where it is of that calibration, as training/METHOD.toml.
Expected<void> write_site(const Site& site,
                          const std::string& calibration,
                          const std::filesystem::path& directory,
                          const std::map<std::string, std::string>& refined = {});

Expected<std::string> read_file(const std::filesystem::path& file);

// Whether `path` is in that folder or below it, through whatever links; false where nobody can
// tell.
bool is_below(const std::filesystem::path& folder, const std::filesystem::path& path);

// Replaces the file in one step: a reader sees the old or the new one.
Expected<void> write_file(const std::filesystem::path& file, const std::string& content);

}  // namespace rayloc
