#include "daemon/live/studio/import_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/live/studio/child_process.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::array<std::string_view, 4> kStatedOptions = {"unit", "scale", "height", "walls"};
constexpr std::string_view kRemark = "  ";  // begins the line of a remark of `rayloc scene import`

// A new folder, removed at the end.
class ImportFolder {
 public:
  explicit ImportFolder(const fs::path& beside)
      : path_((fs::absolute(beside).parent_path() / "import-XXXXXX").string()) {
    error_ = mkdtemp(path_.data()) != nullptr ? 0 : errno;
  }
  ~ImportFolder() {
    std::error_code ignored;
    if (error_ == 0) {
      fs::remove_all(path_, ignored);
    }
  }
  ImportFolder(const ImportFolder&) = delete;
  ImportFolder& operator=(const ImportFolder&) = delete;

  int error() const { return error_; }  // errno; 0: it exists
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int error_ = 0;
};

// Empty: it has not ended before the limit or the stop.
std::optional<int> import_status(ChildProcess& process,
                                 std::chrono::seconds limit,
                                 const std::function<bool()>& is_stopping) {
  constexpr std::chrono::milliseconds kPause{20};
  const auto end = Clock::now() + limit;
  while (Clock::now() < end && !is_stopping()) {
    if (const auto status = process.status()) {
      return status;
    }
    std::this_thread::sleep_for(kPause);
  }
  return process.status();
}

std::string without_line_end(std::string text) {
  while (!text.empty() && text.back() == '\n') {
    text.pop_back();
  }
  return text;
}

std::vector<std::string> remarks_of(const std::string& errors) {
  std::vector<std::string> remarks;
  for (std::size_t at = 0; at < errors.size();) {
    const std::size_t end = std::min(errors.find('\n', at), errors.size());
    const std::string line = errors.substr(at, end - at);
    if (line.starts_with(kRemark)) {
      remarks.push_back(line.substr(kRemark.size()));
    }
    at = end + 1;
  }
  return remarks;
}

Expected<std::map<std::string, std::string>> files_below(const fs::path& folder) {
  std::map<std::string, std::string> files;
  std::error_code failed;
  for (fs::recursive_directory_iterator it(folder, failed), end; !failed && it != end;
       it.increment(failed)) {
    std::error_code unknown;
    if (!it->is_regular_file(unknown)) {
      continue;
    }
    auto content = read_file(it->path());
    RAYLOC_TRY(content);
    files[it->path().lexically_relative(folder).generic_string()] = *std::move(content);
  }
  if (failed) {
    return make_error(ErrorKind::kUnavailable, folder.string() + ": " + failed.message());
  }
  return files;
}

}  // namespace

std::vector<std::string> stated_options(const HttpParameters& parameters) {
  std::vector<std::string> options;
  for (const auto& [name, value] : parameters) {
    if (std::find(kStatedOptions.begin(), kStatedOptions.end(), name) != kStatedOptions.end() &&
        !value.empty()) {
      options.push_back(fmt::format("--{}={}", name, value));
    }
  }
  return options;
}

Expected<ImportedFiles> run_import(const fs::path& program,
                                   const fs::path& file,
                                   const std::vector<std::string>& options,
                                   std::chrono::seconds limit,
                                   const std::function<bool()>& is_stopping) {
  const ImportFolder out(file);
  if (out.error() != 0) {
    return make_error(
        ErrorKind::kUnavailable,
        file.parent_path().string() + ": cannot create a folder: " + std::strerror(out.error()));
  }
  std::vector<std::string> arguments{
      "scene", "import", fs::absolute(file).string(), "--out", out.path()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const auto process = ChildProcess::start(program, arguments);
  RAYLOC_TRY(process);
  const auto status = import_status(**process, limit, is_stopping);
  const std::string place = file.string() + ": ";
  if (!status && is_stopping()) {
    return make_error(ErrorKind::kUnavailable,
                      place + "its reading was ended with the studio; import it again");
  }
  if (!status) {
    return bad_input(
        fmt::format("{}takes longer than {} s to read, and its reading was ended; "
                    "export a part of it, or as GLB",
                    place,
                    limit.count()));
  }
  const std::string errors = (*process)->errors();
  if (*status > ChildProcess::kBySignal) {
    return bad_input(
        fmt::format("{}the program that reads this format ended by signal {}; export "
                    "the file again, or in another format, best as GLB",
                    place,
                    *status - ChildProcess::kBySignal));
  }
  if (*status != 0) {
    const std::string message = without_line_end(errors);
    return make_error(
        *status == ChildProcess::kCannotStart ? ErrorKind::kUnavailable : ErrorKind::kBadInput,
        message.empty() ? fmt::format("{}cannot be read (exit status {})", place, *status)
                        : message);
  }
  auto files = files_below(out.path());
  RAYLOC_TRY(files);
  return ImportedFiles{*std::move(files), remarks_of(errors)};
}

}  // namespace rayloc
