#include "daemon/pipeline/record/rotating_recorder.h"

#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "capture/record/recording_repair.h"
#include "daemon/pipeline/record/recording_folder.h"
#include "daemon/pipeline/record/system_now.h"

namespace rayloc {
namespace {

constexpr std::chrono::seconds kDiskCheckInterval{1};  // of checks of the free room on the disk
constexpr std::chrono::seconds kTidyInterval{5};  // of the folder; maximum loss at a power failure
constexpr std::size_t kMaxGaps = 8;               // waiting for a file

}  // namespace

RotatingRecorder::RotatingRecorder(RotatingRecorderOptions options)
    : options_(std::move(options)), opened_(options_.steady()), tidied_(opened_) {
  if (!options_.now) {
    options_.now = system_now;
  }
  if (!options_.free_bytes) {
    options_.free_bytes = [folder = options_.folder] { return free_disk_bytes(folder); };
  }
  if (make_recording_folder(options_.folder)) {  // otherwise open_first_file() reports it
    check_disk();
  }
  open_first_file();
}

RotatingRecorder::~RotatingRecorder() { close(); }

// Opens the next file for writing; the one before is closed and gets its name.
Expected<void> RotatingRecorder::open_file() {
  RAYLOC_TRY(make_recording_folder(options_.folder));
  const std::string path =
      free_recording_name(options_.folder, options_.name, options_.now()).string() + kPartSuffix;
  if (recorder_) {
    const std::string before = recorder_->path();
    RAYLOC_TRY(recorder_->continue_in(path));
    name_finished(before);
  } else {
    Expected<PcapRecorder> created = PcapRecorder::create(path);
    RAYLOC_TRY(created);
    recorder_.emplace(std::move(*created));
  }
  // Until it is closed: a daemon that starts meanwhile must not treat it as a leftover.
  flock(recorder_->descriptor(), LOCK_EX | LOCK_NB);
  opened_ = options_.steady();
  records_ = 0;
  synced_bytes_ = recorder_->counters().bytes;
  counters_.bytes += recorder_->counters().bytes;
  return {};
}

void RotatingRecorder::name_finished(const std::string& part) {
  const std::string path = part.substr(0, part.size() - std::strlen(kPartSuffix));
  if (records_ == 0) {
    unlink(part.c_str());
  } else if (std::rename(part.c_str(), path.c_str()) == 0) {
    ++counters_.files;
    name_error_.clear();
  } else {
    name_error_ = part + ": cannot be renamed: " + std::strerror(errno) +
                  "; it gets its name when raylocd is started again";
  }
  sync_folder_of(path);
}

void RotatingRecorder::close() {
  if (!recorder_) {
    return;
  }
  if (!gaps_.empty()) {
    // A last attempt: it needs some hundred bytes.
    std::vector<Datagram> marks;
    std::vector<std::string> texts;
    mark_gaps(marks, texts, last_);
    if (recorder_->write(marks)) {
      counters_.gaps += gaps_.size();
      records_ += marks.size();
      gaps_.clear();
    }
  }
  const std::string path = recorder_->path();
  recorder_->sync();
  recorder_.reset();
  name_finished(path);
}

void RotatingRecorder::check_disk() {
  checked_ = options_.steady();
  const std::uint64_t least = options_.limits.min_free_bytes;
  const std::uint64_t free = options_.free_bytes();
  // Resuming needs somewhat more room than stopping, to avoid doing both every second.
  const bool stop = free < (counters_.stopped ? least + least / 16 : least);
  counters_.stops += stop && !counters_.stopped ? 1U : 0U;
  if (stop) {
    counters_.error = options_.folder.string() +
                      ": less than min_free_mb = " + std::to_string(least >> 20U) +
                      " MiB are free: nothing is recorded until there is room";
  } else if (counters_.stopped) {
    counters_.error.clear();
  }
  counters_.stopped = stop;
}

// While no file is open: the obstacle may be removed within a second.
void RotatingRecorder::open_first_file() {
  if (!recorder_ && !counters_.stopped) {
    const Expected<void> opened = open_file();
    counters_.error = opened ? "" : opened.error().message;
  }
}

void RotatingRecorder::rotate() {
  if (!recorder_ || records_ == 0 || counters_.stopped) {
    return;
  }
  const Debounce now = options_.steady();
  const bool full = recorder_->counters().bytes >= options_.limits.rotate_bytes;
  const bool old = now - opened_ >= options_.limits.rotate_every;
  if ((full || old) && now >= rotate_next_) {
    const Expected<void> opened = open_file();
    rotate_error_ = opened ? "" : opened.error().message;  // the old file continues
    rotate_next_ = opened ? now : now + kDiskCheckInterval;
  }
}

void RotatingRecorder::keep_house() {
  const Debounce now = options_.steady();
  if (now - checked_ >= kDiskCheckInterval) {
    check_disk();
    open_first_file();
  }
  rotate();
  if (now - tidied_ >= kTidyInterval) {
    tidied_ = now;
    counters_.removed += remove_oldest_recordings(options_.folder, options_.limits.max_total_bytes);
    if (recorder_ && recorder_->counters().bytes != synced_bytes_) {
      synced_bytes_ = recorder_->counters().bytes;
      if (const Expected<void> synced = recorder_->sync(); !synced) {
        counters_.error = synced.error().message;
      }
    }
  }
}

void RotatingRecorder::write(std::span<const Datagram> batch) {
  keep_house();
  if (batch.empty()) {
    return;
  }
  counters_.given += batch.size();
  if (counters_.stopped) {
    lose(batch, "no_room");
    return;
  }
  if (!recorder_) {
    lose(batch, "write_failed");
    return;
  }
  const Expected<void> written = append(batch);
  if (written) {
    counters_.written += batch.size();
    counters_.error = rotate_error_.empty() ? name_error_ : rotate_error_;
  } else {
    counters_.error = written.error().message;
    lose(batch, "write_failed");
  }
}

Expected<void> RotatingRecorder::append(std::span<const Datagram> batch) {
  const std::uint64_t before = recorder_->counters().bytes;
  Expected<void> written;
  if (gaps_.empty()) {
    written = recorder_->write(batch);
  } else {
    std::vector<Datagram> marked;
    std::vector<std::string> texts;
    mark_gaps(marked, texts, batch.front().time);
    marked.insert(marked.end(), batch.begin(), batch.end());
    written = recorder_->write(marked);
  }
  if (written) {
    counters_.gaps += gaps_.size();
    records_ += batch.size() + gaps_.size();
    gaps_.clear();
    last_ = batch.back().time;
    counters_.bytes += recorder_->counters().bytes - before;
  }
  return written;
}

// The marks refer to `texts`.
void RotatingRecorder::mark_gaps(std::vector<Datagram>& batch,
                                 std::vector<std::string>& texts,
                                 Timestamp time) const {
  texts.reserve(gaps_.size());
  for (const RecordingGap& gap : gaps_) {
    texts.push_back(gap_text(gap));
    batch.push_back(gap_mark(texts.back(), time));
  }
}

void RotatingRecorder::lose(std::span<const Datagram> batch, const std::string& reason) {
  counters_.lost += batch.size();
  note_dropped(batch.size(), reason, batch.front().time, batch.back().time);
}

void RotatingRecorder::note_dropped(std::uint64_t datagrams,
                                    const std::string& reason,
                                    Timestamp from,
                                    Timestamp to) {
  if (!gaps_.empty() && (gaps_.back().reason == reason || gaps_.size() >= kMaxGaps)) {
    *gaps_.back().datagrams += datagrams;
    gaps_.back().to = to;
  } else {
    gaps_.push_back({datagrams, reason, from, to});
  }
  last_ = std::max(last_, to);
}

}  // namespace rayloc
