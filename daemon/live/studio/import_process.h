// The import of a file that a browser sent, in a process of its own: readers of other programs'
// formats are large, and a fault in one of them must not end the studio.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "daemon/live/http/http_server.h"
#include "engine/base/expected.h"

namespace rayloc {

struct ImportedFiles {
  std::map<std::string, std::string> files;  // of a site: content by name
  std::vector<std::string> remarks;          // recognised, assumed and omitted content
};

// The parameters of an upload that are options of `rayloc scene import`, which checks their values.
// Others are left out: they could name a file, or a folder to write to.
std::vector<std::string> stated_options(const HttpParameters& parameters);

// Runs `PROGRAM scene import FILE` with these options and waits for it. A new folder beside FILE
// holds the result meanwhile. Errors (kBadInput): the message of the program; a message
// if a signal ended the program, or if it was ended after `limit`. kUnavailable: it cannot be
// started, or it was ended because `is_stopping` returned true, which is called several times per
// second by this thread. Thread-safe for files in different folders.
Expected<ImportedFiles> run_import(const std::filesystem::path& program,
                                   const std::filesystem::path& file,
                                   const std::vector<std::string>& options,
                                   std::chrono::seconds limit,
                                   const std::function<bool()>& is_stopping);

}  // namespace rayloc
