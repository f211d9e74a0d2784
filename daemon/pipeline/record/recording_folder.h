// The folder that recordings are written to: their names, how much room they take, which of them
// has to go.
//
// Only files that are named as a recorder names them are looked at: AP-20261121T140509Z.pcap, with
// "-2", "-3" ... behind the time where one second brings several, and ".part" behind it all while
// it is written. Thread safety: any thread; several may use one folder.
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

// The part of the name that orders recordings by age ("20261121T140509Z-2"); empty when a recorder
// would not have named a file so.
std::string recording_age_key(const std::filesystem::path& file);

// A path in `folder` that neither a recording nor a part of one has, without kPartSuffix.
std::filesystem::path free_recording_name(const std::filesystem::path& folder,
                                          const std::string& name,
                                          Timestamp time);

// Makes the folder where there is none. kUnavailable when that fails.
Expected<void> make_recording_folder(const std::filesystem::path& folder);

// Removes the oldest recordings until all of them, those that are being written included, take no
// more than `bytes`; how many went. What is being written stays.
std::uint64_t remove_oldest_recordings(const std::filesystem::path& folder, std::uint64_t bytes);

// Makes recordings of what was left behind by a crash (capture/record/recording_repair.h); `log`
// gets a line for each. How many were repaired. `now`: of the gap that is marked.
std::uint64_t repair_recordings(const std::filesystem::path& folder,
                                Timestamp now,
                                const std::function<void(const std::string& line)>& log);

// Those of that name (of an access point) that were still written to at `since` or later, the
// oldest first; the one that is being written included.
std::vector<std::filesystem::path> recordings_since(const std::filesystem::path& folder,
                                                    const std::string& name,
                                                    Timestamp since);

// What an unprivileged process may still write to that disk; all there is when nobody can tell.
std::uint64_t free_disk_bytes(const std::filesystem::path& folder);

}  // namespace rayloc
