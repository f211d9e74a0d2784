#include "daemon/pipeline/record/ring_snapshots.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include "capture/record/pcap_format.h"
#include "capture/record/recording_repair.h"
#include "daemon/pipeline/record/recording_folder.h"
#include "daemon/pipeline/record/system_now.h"

namespace rayloc {
namespace {

tl::unexpected<Error> cannot_write(const std::string& path, const std::string& why) {
  return make_error(ErrorKind::kUnavailable, path + ": cannot be written: " + why);
}

bool write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
  return true;
}

}  // namespace

RingSnapshots::RingSnapshots(std::vector<Source> sources,
                             std::filesystem::path folder,
                             const Limits& limits)
    : sources_(std::move(sources)), folder_(std::move(folder)), limits_(limits) {}

RingSnapshots::~RingSnapshots() { finish(); }

void RingSnapshots::finish() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  if (thread_.joinable()) {
    thread_.join();
  }
}

Expected<std::vector<std::string>> RingSnapshots::request() {
  std::vector<File> files;
  const Timestamp now = system_now();
  const std::lock_guard lock(mutex_);
  if (ending_) {
    return make_error(ErrorKind::kUnavailable, "raylocd is stopping");
  }
  if (writing_) {
    return make_error(ErrorKind::kUnavailable, "a snapshot is being written already");
  }
  std::vector<std::string> paths;
  for (const Source& source : sources_) {
    auto pieces = source.ring->contents();
    if (!pieces.empty()) {
      const std::string name = source.access_point + "-snapshot";
      paths.push_back(free_recording_name(folder_, name, now).string());
      files.push_back({paths.back(), std::move(pieces)});
    }
  }
  if (files.empty()) {
    return make_error(ErrorKind::kUnavailable,
                      "there is nothing to write: no source has received a datagram");
  }
  if (thread_.joinable()) {  // that of the snapshot before, which does not write any more
    thread_.join();
  }
  try {
    thread_ = std::thread([this, files = std::move(files)] { run(files); });
  } catch (const std::system_error& error) {
    return make_error(ErrorKind::kUnavailable,
                      std::string("no thread for the snapshot: ") + error.what());
  }
  writing_ = true;
  return paths;
}

void RingSnapshots::set_limits(const Limits& limits) {
  const std::lock_guard lock(mutex_);
  limits_ = limits;
}

void RingSnapshots::run(const std::vector<File>& files) {
  for (const File& file : files) {
    write(file);
  }
  const std::lock_guard lock(mutex_);
  writing_ = false;
}

void RingSnapshots::write(const File& file) {
  std::unique_lock lock(mutex_);
  const Limits limits = limits_;
  lock.unlock();
  const Expected<std::uint64_t> datagrams = write_file(file, limits.min_free_bytes);
  remove_oldest_recordings(folder_, limits.max_total_bytes);
  lock.lock();
  (datagrams ? counters_.files : counters_.failed) += 1;
  notices_.push_back("snapshot: " +
                     (datagrams ? file.path + ": " + std::to_string(*datagrams) + " datagrams"
                                : datagrams.error().message));
}

// Returns the number of its datagrams.
Expected<std::uint64_t> RingSnapshots::write_file(const File& file,
                                                  std::uint64_t min_free_bytes) const {
  std::uint64_t bytes = 0;
  for (const auto& piece : file.pieces) {
    bytes += piece->bytes();
  }
  RAYLOC_TRY(make_recording_folder(folder_));
  const std::uint64_t free = free_disk_bytes(folder_);
  if (free < min_free_bytes || free - min_free_bytes < bytes) {
    return cannot_write(file.path, "less than min_free_mb would be left");
  }
  const std::string part = file.path + kPartSuffix;
  constexpr mode_t kMode = 0640;
  const int fd = open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (fd < 0) {
    return cannot_write(part, std::strerror(errno));
  }
  flock(fd, LOCK_EX | LOCK_NB);
  std::uint64_t datagrams = 0;
  std::vector<std::byte> records = pcap_file_header();
  bool good = write_all(fd, records);
  for (const auto& piece : file.pieces) {
    records.clear();
    for (const Datagram& datagram : piece->datagrams()) {
      datagrams += append_pcap_record(datagram, records) ? 1U : 0U;
    }
    good = good && write_all(fd, records);
  }
  good = good && fdatasync(fd) == 0 && std::rename(part.c_str(), file.path.c_str()) == 0;
  const int error = errno;
  close(fd);
  if (!good) {
    unlink(part.c_str());
    return cannot_write(file.path, std::strerror(error));
  }
  sync_folder_of(file.path);
  return datagrams;
}

RingSnapshotCounters RingSnapshots::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

std::vector<std::string> RingSnapshots::notices() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notices_, {});
}

}  // namespace rayloc
