#include "capture/record/recording_repair.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "capture/record/pcap_format.h"
#include "capture/record/pcap_parser.h"
#include "capture/record/recording_gap.h"
#include "capture/transport/file_descriptor.h"

namespace rayloc {
namespace {

// Minimum size of a recorder's record: its header, and those around an empty datagram. Shorter ones
// are the zeros with which a power failure fills a file.
constexpr std::size_t kMinRecordBytes = 16 + 14 + 20 + 8;
constexpr std::size_t kReadBytes = std::size_t{1} << 20U;

tl::unexpected<Error> cannot_repair(const std::string& path) {
  return make_error(ErrorKind::kUnavailable,
                    path + ": cannot be repaired: " + std::strerror(errno));
}

// The whole records at the beginning of a file.
struct WholePart {
  std::uint64_t records = 0;
  std::uint64_t bytes = 0;  // including the header of the file
  Timestamp last{};         // time of the last one
};

// Returns false at the first data that is no whole record.
bool take_records(pcap::PcapParser& parser, pcap::Bytes window, WholePart& whole) {
  while (true) {
    const pcap::PcapParser::Step step = parser.next(window);
    if (step.status == pcap::PcapParser::Status::kNeedMore) {
      return true;
    }
    const bool packet = step.status == pcap::PcapParser::Status::kPacket;
    if (step.status == pcap::PcapParser::Status::kError ||
        (packet && step.size < kMinRecordBytes) ||
        (packet && step.packet.link_type == pcap::kLinkTypeIntel5300)) {  // not a recording of ours
      return false;
    }
    if (packet) {
      ++whole.records;
      whole.last = step.packet.time.value_or(whole.last);
    }
    whole.bytes += step.size;
    window = window.subspan(step.size);
  }
}

Expected<WholePart> find_whole_part(int fd, const std::string& path) {
  pcap::PcapParser parser;
  WholePart whole;
  std::vector<std::byte> bytes;
  for (std::uint64_t read_to = 0;;) {
    const std::size_t kept = read_to - whole.bytes;
    bytes.resize(kept + kReadBytes);
    const ssize_t got = pread(fd, bytes.data() + kept, kReadBytes, static_cast<off_t>(read_to));
    if (got < 0) {
      return cannot_repair(path);
    }
    read_to += static_cast<std::uint64_t>(got);
    const std::uint64_t before = whole.bytes;
    const pcap::Bytes window(bytes.data(), kept + static_cast<std::size_t>(got));
    if (got == 0 || !take_records(parser, window, whole)) {
      return whole;
    }
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(whole.bytes - before));
  }
}

// The mark of the datagrams that were not recorded since.
std::vector<std::byte> mark_of(const WholePart& whole, Timestamp now) {
  const std::string text = gap_text({{}, "killed", whole.last, std::max(now, whole.last)});
  std::vector<std::byte> record;
  append_pcap_record(gap_mark(text, whole.last), record);
  return record;
}

}  // namespace

Expected<RecordingRepair> repair_recording(const std::string& path, Timestamp now) {
  const FileDescriptor file(open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (file.get() < 0) {
    return cannot_repair(path);
  }
  RecordingRepair repair;
  if (flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    repair.result = RecordingRepair::Result::kInUse;
    return repair;
  }
  const Expected<WholePart> whole = find_whole_part(file.get(), path);
  struct stat status {};
  if (!whole || fstat(file.get(), &status) != 0) {
    return whole ? cannot_repair(path) : tl::make_unexpected(whole.error());
  }
  repair.records = whole->records;
  repair.cut_bytes = static_cast<std::uint64_t>(status.st_size) - whole->bytes;
  if (whole->records == 0) {
    repair.result = RecordingRepair::Result::kEmpty;
    return unlink(path.c_str()) == 0 ? Expected<RecordingRepair>(repair) : cannot_repair(path);
  }
  const std::vector<std::byte> mark = mark_of(*whole, now);
  const std::string whole_path = path.substr(0, path.size() - std::strlen(kPartSuffix));
  if (ftruncate(file.get(), static_cast<off_t>(whole->bytes)) != 0 ||
      pwrite(file.get(), mark.data(), mark.size(), static_cast<off_t>(whole->bytes)) !=
          static_cast<ssize_t>(mark.size()) ||
      fdatasync(file.get()) != 0 || rename(path.c_str(), whole_path.c_str()) != 0) {
    return cannot_repair(path);
  }
  sync_folder_of(whole_path);
  return repair;
}

void sync_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int fd = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd >= 0) {
    fsync(fd);
    close(fd);
  }
}

}  // namespace rayloc
