// answer_of(): all datagrams and reports of a recording, for tests of recordings.
#pragma once

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/source/recorded_source.h"
#include "tests/support/pcap_files.h"

namespace rayloc::test {

struct RecordingAnswer {
  std::vector<Timestamp> times;  // of each datagram
  std::vector<ByteString> payloads;
  SourceCounters counters;
  std::vector<std::string> words;  // notes of the scan of the file, then warnings
  std::string error;               // of a read, which ends the reading
};

inline RecordingAnswer answer_of(const std::string& path) {
  RecordingAnswer answer;
  auto source = RecordedSource::open({path});
  if (!source) {
    answer.error = source.error().message;
    return answer;
  }
  DatagramBatch batch;
  while (!batch.ended && answer.error.empty()) {
    const auto read = (*source)->read(batch, std::chrono::seconds(1));
    answer.error = read ? "" : read.error().message;
    for (const Datagram& datagram : batch.datagrams) {
      answer.times.push_back(datagram.time);
      answer.payloads.emplace_back(reinterpret_cast<const char*>(datagram.payload.data()),
                                   datagram.payload.size());
    }
  }
  answer.counters = (*source)->counters();
  answer.words = describe((*source)->plan());
  const auto warnings = (*source)->warnings();
  answer.words.insert(answer.words.end(), warnings.begin(), warnings.end());
  return answer;
}

// The output of a shell command, through a pipe.
inline RecordingAnswer read_command(const std::string& command) {
  std::FILE* const pipe = popen(command.c_str(), "r");
  RecordingAnswer answer = answer_of("/dev/fd/" + std::to_string(fileno(pipe)));
  pclose(pipe);
  return answer;
}

inline RecordingAnswer read_as_file(const ByteString& bytes) {
  const std::string path = temporary_path("recording.pcap");
  write_file(path, bytes);
  RecordingAnswer answer = answer_of(path);
  std::filesystem::remove(path);
  return answer;
}

inline RecordingAnswer read_as_pipe(const ByteString& bytes) {
  const std::string path = temporary_path("recording.pipe");
  write_file(path, bytes);
  RecordingAnswer answer = read_command("cat " + path);
  std::filesystem::remove(path);
  return answer;
}

inline std::vector<RecordingAnswer> read_both(const ByteString& bytes) {
  return {read_as_file(bytes), read_as_pipe(bytes)};
}

}  // namespace rayloc::test
