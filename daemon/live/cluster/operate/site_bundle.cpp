#include "daemon/live/cluster/operate/site_bundle.h"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/operate/stream_admin.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kPiece = std::size_t{512} << 10U;           // bytes: half of a server's limit
constexpr std::size_t kMaxBundleBytes = std::size_t{256} << 20U;  // bytes of a bundle
constexpr std::string_view kCurrent = "_current";                 // differs from any hash
// Files that calibration needs and raylocd does not.
constexpr std::array<std::string_view, 6> kLeftOut = {
    ".pcap", ".pcapng", ".gz", ".csv", ".html", ".svg"};

std::string subject_of(const std::string& site, std::string_view last) {
  return "rayloc.v1.bundle." + subject_token(site) + "." + std::string(last);
}

tl::unexpected<Error> refuse(const std::string& what) {
  return make_error(ErrorKind::kBadInput, what);
}

bool is_left_out(const fs::path& file) {
  if (file.parent_path().filename() == "patterns") {
    return false;  // tables of antennas
  }
  const std::string extension = file.extension().string();
  return std::find(kLeftOut.begin(), kLeftOut.end(), extension) != kLeftOut.end();
}

Expected<std::string> content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(in)), {});
  return in.bad() || !in.is_open() ? refuse(file.string() + ": cannot be read")
                                   : Expected<std::string>(std::move(content));
}

// Record after the pieces.
json manifest_of(const SiteBundle& bundle, const std::string& hash, std::size_t pieces) {
  json files = json::array();
  for (const auto& [path, content] : bundle.files) {
    files.push_back({{"path", path}, {"bytes", content.size()}});
  }
  return {{"hash", hash}, {"pieces", pieces}, {"files", std::move(files)}};
}

bool is_manifest(const json& manifest) {
  const auto has = [](const json& object, const char* key, json::value_t type) {
    return object.is_object() && object.contains(key) && object.at(key).type() == type;
  };
  if (!has(manifest, "hash", json::value_t::string) ||
      !has(manifest, "pieces", json::value_t::number_unsigned) ||
      !has(manifest, "files", json::value_t::array)) {
    return false;
  }
  const json& files = manifest.at("files");
  return std::all_of(files.begin(), files.end(), [&](const json& file) {
    return has(file, "path", json::value_t::string) &&
           has(file, "bytes", json::value_t::number_unsigned);
  });
}

Expected<std::optional<json>> current_of(Broker& broker, const std::string& site) {
  const auto entry = broker.last_of(std::string(kBundleStream), subject_of(site, kCurrent));
  RAYLOC_TRY(entry);
  if (!*entry) {
    return std::nullopt;
  }
  json manifest = json::parse((*entry)->data, nullptr, false);
  if (!is_manifest(manifest)) {
    return refuse("site '" + site + "': its entry in " + std::string(kBundleStream) +
                  " is none; apply the site again");
  }
  return manifest;
}

// Sets the entry of the site; the pieces of the previous bundle are deleted.
Expected<void> enter(Broker& broker, const std::string& site, const json& manifest) {
  const std::string entry = subject_of(site, kCurrent);
  const auto before = broker.last_of(std::string(kBundleStream), entry);
  RAYLOC_TRY(before);
  const auto sent =
      broker.publish_behind(entry, manifest.dump(), *before ? (*before)->sequence : 0);
  RAYLOC_TRY(sent);
  if (!sent->is_last) {
    return make_error(
        ErrorKind::kUnavailable,
        "site '" + site +
            "': another client has changed it meanwhile; check its state, and try again");
  }
  const json old = *before ? json::parse((*before)->data, nullptr, false) : json();
  const std::string old_hash = old.is_object() ? old.value("hash", "") : "";
  return old_hash.empty() || old_hash == manifest.value("hash", "")
             ? Expected<void>()
             : forget_subjects(
                   broker, std::string(kBundleStream), subject_of(site, old_hash + ".>"));
}

std::string joined(const SiteBundle& bundle) {
  std::string all;
  for (const auto& [path, content] : bundle.files) {
    all += content;
  }
  return all;
}

Expected<SiteBundle> split(const json& manifest, const std::string& all) {
  SiteBundle bundle;
  std::size_t at = 0;
  for (const json& file : manifest.value("files", json::array())) {
    const std::size_t bytes = file.value("bytes", std::size_t{0});
    if (bytes > all.size() - at) {
      return refuse("a bundle is shorter than its entry states");
    }
    bundle.files[file.value("path", "")] = all.substr(at, bytes);
    at += bytes;
  }
  return bundle;
}

}  // namespace

std::string bundle_notices() { return "rayloc.v1.bundled.*." + std::string(kCurrent); }

std::string SiteBundle::hash() const {
  if (sodium_init() < 0) {
    throw std::runtime_error("libsodium cannot be initialised");
  }
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, crypto_generichash_BYTES);
  const auto add = [&](const std::string& text) {
    // With its length: otherwise different sequences could join to the same text.
    const std::string whole = std::to_string(text.size()) + ":" + text;
    crypto_generichash_update(
        &state, reinterpret_cast<const unsigned char*>(whole.data()), whole.size());
  };
  for (const auto& [path, content] : files) {
    add(path);
    add(content);
  }
  std::array<unsigned char, crypto_generichash_BYTES> digest{};
  crypto_generichash_final(&state, digest.data(), digest.size());
  std::array<char, 2 * crypto_generichash_BYTES + 1> hex{};
  sodium_bin2hex(hex.data(), hex.size(), digest.data(), digest.size());
  return hex.data();
}

Expected<SiteBundle> read_bundle(const fs::path& folder) {
  SiteBundle bundle;
  std::size_t bytes = 0;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, failed)) {
    if (entry.is_symlink()) {
      return refuse(entry.path().string() + ": a link, which another machine cannot follow");
    }
    if (!entry.is_regular_file() || is_left_out(entry.path())) {
      continue;
    }
    Expected<std::string> content = content_of(entry.path());
    RAYLOC_TRY(content);
    bytes += content->size();
    if (bytes > kMaxBundleBytes) {
      return refuse(folder.string() +
                    ": more than 256 MiB; a site is its plan and what was learned");
    }
    bundle.files[fs::relative(entry.path(), folder).generic_string()] = std::move(*content);
  }
  if (failed) {
    return refuse(folder.string() + ": " + failed.message());
  }
  return bundle;
}

Expected<void> write_bundle(const SiteBundle& bundle, const fs::path& folder) {
  for (const auto& [name, content] : bundle.files) {
    const fs::path path = fs::path(name).lexically_normal();
    if (name.empty() || path.is_absolute() || *path.begin() == "..") {
      return refuse("a bundle with a file called '" + name + "'");
    }
    std::error_code failed;
    fs::create_directories((folder / path).parent_path(), failed);
    std::ofstream out(folder / path, std::ios::binary);
    out << content << std::flush;
    if (!out) {
      return make_error(ErrorKind::kUnavailable, (folder / path).string() + ": cannot be written");
    }
  }
  return {};
}

Expected<void> store_bundle(Broker& broker,
                            const std::string& site,
                            const SiteBundle& bundle,
                            int replicas) {
  StreamOptions stream;
  stream.name = kBundleStream;
  stream.subjects = "rayloc.v1.bundle.>";
  stream.republish_to = "rayloc.v1.bundled.>";
  stream.in_memory = false;
  stream.replicas = replicas;
  stream.max_age = std::chrono::seconds(0);
  stream.max_messages_per_subject = 1;
  RAYLOC_TRY(broker.ensure_stream(stream));
  const std::string hash = bundle.hash();
  const std::string all = joined(bundle);
  const std::size_t pieces = (all.size() + kPiece - 1) / kPiece;
  for (std::size_t i = 0; i < pieces; ++i) {
    const std::string subject = subject_of(site, hash + "." + std::to_string(i));
    // An existing piece is the same.
    RAYLOC_TRY(broker.publish_behind(subject, std::string_view(all).substr(i * kPiece, kPiece), 0));
  }
  return enter(broker, site, manifest_of(bundle, hash, pieces));
}

Expected<void> retract_bundle(Broker& broker, const std::string& site) {
  return enter(broker, site, manifest_of({}, "", 0));
}

Expected<std::map<std::string, std::string>> stored_bundles(Broker& broker) {
  std::map<std::string, std::string> hashes;
  const auto streams = streams_of(broker);
  RAYLOC_TRY(streams);
  if (std::none_of(streams->begin(), streams->end(), [](const StreamReport& stream) {
        return stream.options.name == kBundleStream;
      })) {
    return hashes;
  }
  const auto subjects = subjects_of(broker, std::string(kBundleStream));
  RAYLOC_TRY(subjects);
  for (const std::string& subject : *subjects) {
    if (last_token(subject) != kCurrent) {
      continue;
    }
    const std::string_view token =
        last_token(std::string_view(subject).substr(0, subject.size() - kCurrent.size() - 1));
    const std::string site = token_name(token);
    const auto manifest = current_of(broker, site);
    RAYLOC_TRY(manifest);
    if (*manifest) {
      hashes[site] = (**manifest).value("hash", "");
    }
  }
  return hashes;
}

Expected<SiteBundle> fetch_bundle(Broker& broker,
                                  const std::string& site,
                                  const std::string& hash) {
  const auto manifest = current_of(broker, site);
  RAYLOC_TRY(manifest);
  if (!*manifest || (**manifest).value("hash", "") != hash) {
    return refuse("site '" + site + "' has another bundle by now");
  }
  std::string all;
  for (std::size_t i = 0; i < (**manifest).value("pieces", std::size_t{0}); ++i) {
    const auto piece = broker.last_of(std::string(kBundleStream),
                                      subject_of(site, hash + "." + std::to_string(i)));
    RAYLOC_TRY(piece);
    if (!*piece) {
      return refuse("site '" + site + "': a piece of its bundle is missing; apply it again");
    }
    all += (*piece)->data;
  }
  auto bundle = split(**manifest, all);
  if (bundle && bundle->hash() != hash) {
    return refuse("site '" + site + "': its bundle has changed bytes; apply it again");
  }
  return bundle;
}

}  // namespace rayloc
