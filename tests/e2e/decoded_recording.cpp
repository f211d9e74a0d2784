#include "tests/e2e/decoded_recording.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <gtest/gtest.h>

#include "capture/assemble/csi_receiver.h"
#include "capture/source/pcap_source.h"
#include "daemon/messages/csi_message.h"
#include "rayloc/v1/csi.pb.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e {
namespace {

constexpr std::size_t kDatagrams = 120;
constexpr std::size_t kFileHeader = 24;
constexpr std::size_t kRecordHeader = 16;
constexpr std::size_t kTime = 8;          // of a record's header
constexpr std::size_t kFramesLater = 12;  // datagrams: a frame has long been given on without one
// Ethernet, IP and UDP before the payload; in it the transmitter's address before the frame
// counter.
constexpr std::size_t kCounter = kRecordHeader + 14 + 20 + 8 + 6;

// The records of the file, without its header.
std::vector<std::string> records_of(const std::string& bytes, std::size_t count) {
  std::vector<std::string> records;
  for (std::size_t at = kFileHeader;
       records.size() < count && at + kRecordHeader <= bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at + 8, sizeof length);
    records.push_back(bytes.substr(at, kRecordHeader + length));
    at += records.back().size();
  }
  return records;
}

// The first record behind which a frame of three cores is whole.
std::size_t end_of_a_frame(const std::vector<std::string>& records) {
  const auto counter = [&](std::size_t i) { return records[i].substr(kCounter, 2); };
  std::size_t i = 2;
  while (i + 1 < records.size() && counter(i) != counter(i - 2)) {
    ++i;
  }
  return i;
}

std::string nonsense(std::string record) {
  std::fill(record.begin() + kCounter, record.end(), '\xff');
  return record;
}

}  // namespace

CutRecording cut_recording(const std::filesystem::path& folder) {
  const std::filesystem::path whole = folder / "whole.pcap";
  const std::string command =
      "gzip -dc '" + bundled_recording("device_los", "ap2") + "' >'" + whole.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const std::string bytes = read_text(whole);
  std::vector<std::string> records = records_of(bytes, kDatagrams);
  // At the time of the one before.
  const auto insert_behind = [&records](std::size_t index, const std::string& record) {
    std::string moved = record;
    std::copy_n(records[index].begin(), kTime, moved.begin());
    records.insert(records.begin() + static_cast<std::ptrdiff_t>(index) + 1, moved);
  };
  const std::size_t end = end_of_a_frame(records);
  insert_behind(kDatagrams / 2, nonsense(records[kDatagrams / 2]));
  insert_behind(end + kFramesLater, records[end]);
  records.erase(records.begin() + static_cast<std::ptrdiff_t>(end));
  insert_behind(end - 2, records[end - 2]);
  CutRecording cut{folder / "cut.pcap", records.size()};
  std::ofstream out(cut.file, std::ios::binary);
  out << bytes.substr(0, kFileHeader);
  for (const std::string& record : records) {
    out << record;
  }
  return cut;
}

Decoded decode(const std::filesystem::path& recording) {
  auto source =
      PcapFileSource::open(recording.string(), {.port = {}, .max_disorder = kAnyDisorder}).value();
  CsiReceiverOptions options;
  options.format = "axcsi-v4";
  options.expected_rx_chains = {0, 2, 3};  // as site.toml has them
  CsiReceiver receiver(options);
  std::vector<CsiFrame> frames;
  DatagramBatch batch;
  while (!batch.ended && source->read(batch, std::chrono::seconds(1))) {
    for (const Datagram& datagram : batch.datagrams) {
      receiver.push(datagram, frames);
    }
  }
  receiver.flush(frames);
  Decoded decoded;
  for (const CsiFrame& frame : frames) {
    v1::CsiFrame message = csi_message(frame, "ap2", to_string(frame.transmitter));
    message.clear_time();
    decoded.frames.push_back(message.SerializeAsString());
  }
  std::sort(decoded.frames.begin(), decoded.frames.end());
  const CsiReceiverCounters counts = receiver.counters();
  decoded.counters = {{"received", source->counters().received},
                      {"bytes", source->counters().bytes},
                      {"processed", counts.in_frames + counts.duplicates + counts.late},
                      {"duplicates", counts.duplicates},
                      {"late", counts.late},
                      {"frames_complete", counts.frames - counts.partial},
                      {"frames_partial", counts.partial},
                      {"frames_processed", counts.frames}};
  for (const char* const none : {"kernel_drops",
                                 "ring_dropped",
                                 "in_flight",
                                 "frames_dropped",
                                 "frames_in_flight",
                                 "channel_changes"}) {
    decoded.counters[none] = 0;
  }
  for (const auto& rejected : {source->counters().rejected, counts.rejected}) {
    for (const auto& [reason, count] : rejected) {
      decoded.counters["rejected." + reason] += count;
    }
  }
  return decoded;
}

std::map<std::string, std::uint64_t> counters_of(const nlohmann::json& counters) {
  std::map<std::string, std::uint64_t> all;
  for (const auto& [name, value] : counters.items()) {
    if (name == "rejected") {
      for (const auto& [reason, count] : value.items()) {
        all["rejected." + reason] = number(count);
      }
    } else if (name != "clock_steps" && name != "failures") {  // of the machine
      all[name] = number(value);
    }
  }
  return all;
}

}  // namespace rayloc::e2e
