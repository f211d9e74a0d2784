#include "capture/record/pcap_recorder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "capture/record/pcap_format.h"
#include "engine/base/spare_capacity.h"

namespace rayloc {
namespace {

constexpr std::chrono::seconds kSyncInterval{5};

tl::unexpected<Error> cannot_write(const std::string& path, int error) {
  return make_error(ErrorKind::kUnavailable,
                    path + ": cannot be written: " + std::strerror(error) +
                        (error == ENOSPC || error == EFBIG ? "; make room on the disk" : ""));
}

// Creates a file with its header, open for appending.
Expected<int> new_file(const std::string& path) {
  constexpr mode_t kMode = 0640;  // people's positions are private data
  const int fd = open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (fd < 0) {
    const bool exists = errno == EEXIST;
    return make_error(ErrorKind::kUnavailable,
                      path + ": cannot be recorded to: " + std::strerror(errno) +
                          (exists ? "; name a file that does not exist yet" : ""));
  }
  const std::vector<std::byte> header = pcap_file_header();
  if (::write(fd, header.data(), header.size()) != static_cast<ssize_t>(header.size())) {
    const int error = errno;
    unlink(path.c_str());
    close(fd);
    return cannot_write(path, error);
  }
  return fd;
}

}  // namespace

Expected<PcapRecorder> PcapRecorder::create(const std::string& path) {
  const Expected<int> fd = new_file(path);
  RAYLOC_TRY(fd);
  auto writer = AppendProcess::start(*fd);
  if (!writer) {
    unlink(path.c_str());
    close(*fd);
    return tl::make_unexpected(std::move(writer.error()));
  }
  return PcapRecorder(*fd, path, std::move(*writer));
}

Expected<void> PcapRecorder::continue_in(const std::string& path) {
  RAYLOC_TRY(sync());
  const Expected<int> fd = new_file(path);
  RAYLOC_TRY(fd);
  if (const int error = writer_.use(*fd); error != 0) {
    unlink(path.c_str());
    close(*fd);
    return cannot_write(path, error);
  }
  close(fd_);
  fd_ = *fd;
  path_ = path;
  counters_.bytes = pcap_file_header().size();
  return {};
}

PcapRecorder::PcapRecorder(int fd, std::string path, AppendProcess writer)
    : fd_(fd),
      path_(std::move(path)),
      writer_(std::move(writer)),
      synced_(std::chrono::steady_clock::now()) {
  counters_.bytes = pcap_file_header().size();
}

PcapRecorder::PcapRecorder(PcapRecorder&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      writer_(std::move(other.writer_)),
      records_(std::move(other.records_)),
      record_ends_(std::move(other.record_ends_)),
      synced_(other.synced_),
      counters_(other.counters_) {}

PcapRecorder::~PcapRecorder() {
  if (fd_ >= 0) {
    fdatasync(fd_);
    close(fd_);
  }
}

Expected<void> PcapRecorder::write(std::span<const Datagram> batch) {
  if (batch.empty()) {
    return {};
  }
  clear_without_spare(records_);
  clear_without_spare(record_ends_);
  Expected<void> result;
  for (const Datagram& datagram : batch) {
    if (!append_pcap_record(datagram, records_)) {
      result = bad_input(path_ +
                         ": a datagram from before 1970 or after 2106 cannot be recorded;"
                         " set the clock of the machine that received it");
      break;
    }
    record_ends_.push_back(records_.size());
  }
  // Before the batch: an Error must mean that it is lost.
  if (result && std::chrono::steady_clock::now() - synced_ >= kSyncInterval) {
    result = sync();
  }
  if (result) {
    result = append_records();
  }
  counters_.given += batch.size();
  if (result) {
    counters_.delivered += batch.size();
  } else {
    counters_.lost_by["not_written"] += batch.size();
    ++counters_.errors;
  }
  return result;
}

// The end of the append that begins at `begin`: as many whole records as an append may have.
// `record` is the first of them, and is set to the first of the next append.
std::size_t PcapRecorder::next_append(std::size_t begin, std::size_t& record) const {
  std::size_t end = record_ends_[record++];
  while (record < record_ends_.size() && record_ends_[record] - begin <= AppendProcess::kMaxBytes) {
    end = record_ends_[record++];
  }
  return end;
}

Expected<void> PcapRecorder::append_records() {
  const std::span<const std::byte> records(records_);
  std::size_t begin = 0;
  for (std::size_t record = 0; record < record_ends_.size();) {
    const std::size_t end = next_append(begin, record);
    const int error = writer_.append(records.subspan(begin, end - begin));
    if (error != 0) {
      return undo(error);
    }
    begin = end;
  }
  counters_.bytes += records_.size();
  return {};
}

// After a failed batch: removes its records from the file, since all of it is reported lost.
tl::unexpected<Error> PcapRecorder::undo(int error) {
  if (error == EPIPE || error == ECONNRESET) {  // the process was killed, possibly during a write
    if (auto writer = AppendProcess::start(fd_)) {
      writer_ = std::move(*writer);
    }
  }
  struct stat file {};
  const bool longer = fstat(fd_, &file) == 0 && S_ISREG(file.st_mode) &&
                      file.st_size > static_cast<off_t>(counters_.bytes);
  if (longer && ftruncate(fd_, static_cast<off_t>(counters_.bytes)) != 0) {
    return cannot_write(path_, errno);
  }
  return cannot_write(path_, error);
}

Expected<void> PcapRecorder::sync() {
  synced_ = std::chrono::steady_clock::now();
  if (fdatasync(fd_) != 0 && errno != EINVAL) {  // EINVAL: a pipe or a device, e.g. /dev/null
    return cannot_write(path_, errno);
  }
  return {};
}

}  // namespace rayloc
