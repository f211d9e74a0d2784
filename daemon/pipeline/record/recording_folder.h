// The folder that recordings are written to: the names of its files, their total size, and the
// removal of old files.
//
// Only files with names made by a recorder are considered: AP-20261121T140509Z.pcap, with "-2",
// "-3" ... after the time if there are several in one second, and ".part" at the end while it is
// written. Thread safety: any thread; several may use one folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// "20261121T140509Z", UTC.
std::string recording_stamp(Timestamp time);

// The part of the name that orders recordings by age ("20261121T140509Z-2"); empty for a name that
// is not made by a recorder.
std::string recording_age_key(const std::filesystem::path& file);

// An unused path in `folder`, neither a recording nor a part of one, without kPartSuffix.
std::filesystem::path free_recording_name(const std::filesystem::path& folder,
                                          const std::string& name,
                                          Timestamp time);

// Makes the folder if there is none. kUnavailable when that fails.
Expected<void> make_recording_folder(const std::filesystem::path& folder);

// Removes the oldest recordings until all of them, those that are being written included, take no
// more than `bytes`; returns the number removed. A file that is being written stays.
std::uint64_t remove_oldest_recordings(const std::filesystem::path& folder, std::uint64_t bytes);

// Repairs files left behind by a crash (capture/record/recording_repair.h); `log` gets a line for
// each. Returns the number of repaired files. `now`: time of the gap that is marked.
std::uint64_t repair_recordings(const std::filesystem::path& folder,
                                Timestamp now,
                                const std::function<void(const std::string& line)>& log);

// Recordings of that name (of an access point) that were still written to at `since` or later, the
// oldest first; the one that is being written included.
std::vector<std::filesystem::path> recordings_since(const std::filesystem::path& folder,
                                                    const std::string& name,
                                                    Timestamp since);

// Bytes that an unprivileged process may still write to that disk; the maximum when unknown.
std::uint64_t free_disk_bytes(const std::filesystem::path& folder);

}  // namespace rayloc
