// `rayloc cluster apply`: publishes a site for all workers. `rayloc cluster fetch`: writes the
// applied sites as folders that raylocd's configuration includes.
//
// Both verbs refuse a site that fails its checks with a message, and the previous site stays in
// use. A folder is replaced as a whole; raylocd is asked to reload once all are written.
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/cluster_verbs.h"
#include "daemon/cli/verbs/site_check.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/operate/site_bundle.h"
#include "daemon/site/model/site.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kRecheckInterval{10};  // notices may be lost
constexpr std::chrono::milliseconds kApplyStep{200};

// A folder that is removed at the end of its scope.
class Temporary {
 public:
  explicit Temporary(fs::path path) : path_(std::move(path)) { remove(); }
  ~Temporary() { remove(); }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  const fs::path& path() const { return path_; }

 private:
  void remove() const {
    std::error_code failed;
    fs::remove_all(path_, failed);
  }
  fs::path path_;
};

// Creates a temporary folder with a name that no other process can have.
Expected<fs::path> fresh_folder() {
  std::string name = (fs::temp_directory_path() / "rayloc-apply-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    return make_error(ErrorKind::kUnavailable, name + ": no folder can be made there");
  }
  return fs::path(name);
}

// True if the name can be written into a configuration without escapes.
bool is_plain(const std::string& name) {
  return name == printable(name) && name.find_first_of("\"\\") == std::string::npos;
}

// Writes the bundle to an empty folder and checks it as a worker would.
Expected<std::string> check_bundle(const SiteBundle& bundle, const fs::path& folder) {
  if (const Expected<void> written = write_bundle(bundle, folder); !written) {
    return tl::make_unexpected(written.error());
  }
  return check_site(folder);
}

// The line in a file, without its line end; empty if there is no file.
std::string line_of(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

// The applied sites as subfolders of a folder.
class SiteFolder {
 public:
  explicit SiteFolder(fs::path folder) : folder_(std::move(folder)) {}

  // Returns true if a site has changed. A refused site is reported once.
  Expected<bool> follow(Broker& broker) {
    const auto stored = stored_bundles(broker);
    if (!stored) {
      return tl::make_unexpected(stored.error());
    }
    bool changed = false;
    for (const auto& [site, hash] : *stored) {
      if (hash == line_of(hash_file(site)) || (!hash.empty() && hash == refused_[site])) {
        continue;
      }
      if (hash.empty()) {
        changed = take_out(site) || changed;
        continue;
      }
      if (const Expected<void> taken = take(broker, site, hash); taken) {
        changed = true;
        std::fprintf(stderr, "site '%s' is there: %.12s\n", printable(site).c_str(), hash.c_str());
      } else {
        refused_[site] = taken.error().kind == ErrorKind::kUnavailable ? "" : hash;
        std::fprintf(stderr,
                     "site '%s' is left as it was: %s\n",
                     printable(site).c_str(),
                     printable(taken.error().message, '\n').c_str());
      }
    }
    return changed;
  }

 private:
  fs::path path(const std::string& site, const char* end) const {
    return folder_ / (subject_token(site) + end);
  }
  fs::path hash_file(const std::string& site) const { return path(site, ".hash"); }

  // Removes its configuration first: no configuration may refer to a missing folder.
  bool take_out(const std::string& site) const {
    std::error_code failed;
    fs::remove(path(site, ".toml"), failed);
    if (!failed) {
      fs::remove_all(path(site, ""), failed);
    }
    // The hash file goes last: while it exists, the next run detects an incomplete removal.
    const bool was_there = !failed && fs::remove(hash_file(site), failed);
    if (failed) {
      std::fprintf(stderr,
                   "site '%s' cannot be taken out: %s\n",
                   printable(site).c_str(),
                   failed.message().c_str());
    } else if (was_there) {
      std::fprintf(stderr, "site '%s' is taken out\n", printable(site).c_str());
    }
    return was_there;
  }

  Expected<void> take(Broker& broker, const std::string& site, const std::string& hash) const {
    if (!is_plain(site)) {
      return bad_input("its name has a quotation mark, a backslash or what cannot be printed");
    }
    const auto bundle = fetch_bundle(broker, site, hash);
    if (!bundle) {
      return tl::make_unexpected(bundle.error());
    }
    const Temporary fresh(path(site, ".new"));
    if (const auto checked = check_bundle(*bundle, fresh.path()); !checked) {
      return tl::make_unexpected(checked.error());
    }
    const Temporary old(path(site, ".old"));
    std::error_code failed;
    fs::rename(path(site, ""), old.path(), failed);  // fails if there was none
    fs::rename(fresh.path(), path(site, ""), failed);
    if (failed) {
      std::error_code ignored;
      fs::rename(old.path(), path(site, ""), ignored);
      return make_error(ErrorKind::kUnavailable,
                        path(site, "").string() + ": cannot be exchanged: " + failed.message());
    }
    std::ofstream toml(path(site, ".toml"));
    toml << "# Written by `rayloc cluster fetch`.\n[[site]]\nname = \"" << site
         << "\"\ndirectory = \"" << subject_token(site) << "\"\n"
         << std::flush;
    std::ofstream seen(hash_file(site));
    seen << hash << "\n" << std::flush;
    return !toml || !seen
               ? make_error(ErrorKind::kUnavailable, folder_.string() + ": cannot be written")
               : Expected<void>();
  }

  fs::path folder_;
  std::map<std::string, std::string> refused_;  // hash by site
};

void run_command(const std::string& command) {
  if (command.empty()) {
    return;
  }
  if (const int status = std::system(command.c_str()); status != 0) {  // NOLINT: one thread asks
    std::fprintf(stderr, "'%s' ends with status %d\n", command.c_str(), status);
  }
}

}  // namespace

Expected<void> run_cluster_apply(const BrokerOptions& options, const ApplyArguments& arguments) {
  const auto bundle = read_bundle(arguments.folder);
  if (!bundle) {
    return tl::make_unexpected(bundle.error());
  }
  const auto fresh = fresh_folder();
  if (!fresh) {
    return tl::make_unexpected(fresh.error());
  }
  const Temporary around(*fresh);
  const fs::path copy = *fresh / "site";
  const auto checked = check_bundle(*bundle, copy);
  if (!checked) {
    return make_error(
        ErrorKind::kConfiguration,
        arguments.folder + ": not applied, what workers have goes on: " + checked.error().message);
  }
  std::string name = arguments.name;
  if (name.empty()) {
    name = load_site(copy)->name;
  }
  if (!is_plain(name)) {
    return make_error(ErrorKind::kUsage, "'" + printable(name) + "' is no name for a site");
  }
  const auto broker = connect(options);
  if (!broker) {
    return tl::make_unexpected(broker.error());
  }
  if (const auto stored = store_bundle(**broker, name, *bundle, arguments.replicas); !stored) {
    return tl::make_unexpected(stored.error());
  }
  if (Expected<void> open = reopen_claim(**broker, name); !open) {
    return open;
  }
  fmt::print("site {}: {} files, bundle {:.12}: {}\n",
             printable(name),
             bundle->files.size(),
             bundle->hash(),
             printable(*checked));
  return {};
}

Expected<void> run_cluster_fetch(const BrokerOptions& options, const FetchArguments& arguments) {
  StopSignal::install();
  std::error_code failed;
  fs::create_directories(arguments.folder, failed);
  const auto broker = connect(options);
  if (!broker) {
    return tl::make_unexpected(broker.error());
  }
  std::mutex mutex;
  std::condition_variable wake;
  bool is_notified = false;
  const auto subscription = (*broker)->subscribe(bundle_notices(), [&](const BrokerMessage&) {
    const std::lock_guard lock(mutex);
    is_notified = true;
    wake.notify_one();
  });
  if (!subscription) {
    return tl::make_unexpected(subscription.error());
  }
  SiteFolder folder(arguments.folder);
  do {
    const auto changed = folder.follow(**broker);
    if (!changed && !arguments.keep_on) {
      return tl::make_unexpected(changed.error());
    }
    if (changed && *changed) {
      run_command(arguments.command);
    }
    std::unique_lock lock(mutex);
    for (auto waited = kApplyStep;
         arguments.keep_on && !is_notified && waited < kRecheckInterval && !StopSignal::requested();
         waited += kApplyStep) {
      wake.wait_for(lock, kApplyStep);
    }
    is_notified = false;
  } while (arguments.keep_on && !StopSignal::requested());
  return {};
}

}  // namespace rayloc::cli
