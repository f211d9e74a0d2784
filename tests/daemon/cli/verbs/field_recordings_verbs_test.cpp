// Verbs on recordings as they come from the field. Each is a simulated recording of this tree with
// new time stamps, or cut into pieces as by tcpdump -C.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/pcap_files.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::field_recordings_verbs_test {
namespace {

using ::testing::HasSubstr;

const std::string kSite = test::data_path("/sites/meeting_room");
constexpr std::size_t kHeader = 24;
constexpr std::size_t kRecords = 300;

std::uint32_t number_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::string unpacked(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  EXPECT_NE(file, nullptr);
  std::string bytes;
  std::array<char, 65536> chunk{};
  for (int n = 0; (n = gzread(file.get(), chunk.data(), chunk.size())) > 0;) {
    bytes.append(chunk.data(), static_cast<std::size_t>(n));
  }
  return bytes;
}

class EditedRecording {
 public:
  EditedRecording() {
    folder_ = test::temporary_path("field_verbs");
    std::filesystem::create_directories(folder_);
    const std::string file = unpacked(kSite + "/device_los-ap1.pcap.gz");
    header_ = file.substr(0, kHeader);
    for (std::size_t at = kHeader; at < file.size() && records_.size() < kRecords;) {
      const std::size_t size = 16 + number_at(file, at + 8);
      records_.push_back(file.substr(at, size));
      at += size;
    }
    EXPECT_EQ(records_.size(), kRecords);
  }
  ~EditedRecording() { std::filesystem::remove_all(folder_); }
  EditedRecording(const EditedRecording&) = delete;
  EditedRecording& operator=(const EditedRecording&) = delete;

  const std::string& folder() const { return folder_; }

  // The records from `begin` on up to `end`, with so many seconds added to the stamp of each.
  std::string write(
      const std::string& name,
      std::size_t begin,
      std::size_t end,
      const std::function<std::int64_t(std::size_t)>& added = [](std::size_t) { return 0; }) const {
    std::string file = header_;
    for (std::size_t i = begin; i < end; ++i) {
      std::string record = records_[i];
      const auto seconds =
          static_cast<std::uint32_t>(static_cast<std::int64_t>(number_at(record, 0)) + added(i));
      std::memcpy(record.data(), &seconds, sizeof seconds);
      file += record;
    }
    test::write_file(folder_ + "/" + name, file);
    return folder_ + "/" + name;
  }
  std::string whole() const { return write("whole.pcap", 0, kRecords); }

 private:
  std::string folder_;
  std::string header_;
  std::vector<std::string> records_;
};

Finished replay(const std::vector<std::string>& captures) {
  std::vector<std::string> arguments = {"replay", kSite, "--burst", "2s"};
  for (const std::string& capture : captures) {
    arguments.push_back("ap1=" + capture);
  }
  return RaylocProcess(std::move(arguments)).wait();
}
nlohmann::json frames_summary(const std::vector<std::string>& captures) {
  std::vector<std::string> arguments = {"frames", "--json", "--quiet"};
  for (const std::string& capture : captures) {
    arguments.push_back("ap1=" + capture);
  }
  const std::string out = RaylocProcess(std::move(arguments)).wait().out;
  const std::size_t last = out.rfind('\n', out.size() - 2);
  return nlohmann::json::parse(out.substr(last + 1)).at("summary");
}

TEST(Field, ReplayOfARingIsThatOfOneFile) {
  const EditedRecording recording;
  const Finished one = replay({recording.whole()});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_THAT(one.err, HasSubstr("300 packets, 0 rejected"));
  const std::vector<std::string> ring = {recording.write("ring.pcap2", 190, 300),
                                         recording.write("ring.pcap0", 0, 100),
                                         recording.write("ring.pcap1", 100, 190)};
  const Finished several = replay(ring);
  EXPECT_EQ(several.status, 0) << several.err;
  EXPECT_FALSE(one.out.empty());
  EXPECT_EQ(several.out, one.out);
  EXPECT_EQ(frames_summary(ring), frames_summary({recording.whole()}));
}

TEST(Field, ReplayCountsADuplicateOfAnOverlapOnce) {
  const EditedRecording recording;
  const auto summary =
      frames_summary({recording.write("a", 0, 200), recording.write("b", 150, 300)});
  EXPECT_EQ(summary.at("frames"), frames_summary({recording.whole()}).at("frames"));
  EXPECT_EQ(summary.at("duplicates").get<int>() + summary.at("late").get<int>(), 50);
  EXPECT_THAT(replay({recording.write("a", 0, 200), recording.write("b", 150, 300)}).err,
              HasSubstr("they overlap"));
}

TEST(Field, ReplayLosesOneRecordToADamagedStamp) {
  const EditedRecording recording;
  const std::string damaged = recording.write(
      "damaged.pcap", 0, kRecords, [](std::size_t i) { return i == 17 ? 3600 : 0; });
  const Finished finished = replay({damaged});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("300 packets, 1 rejected"));
  EXPECT_THAT(finished.err, HasSubstr("packet 18 (byte "));
  EXPECT_THAT(finished.err, HasSubstr("of 300 packets rejected: 1 damaged_time"));
  EXPECT_EQ(frames_summary({damaged}).at("frames"),
            frames_summary({recording.whole()}).at("frames"));
}

TEST(Field, ReplayGoesOnOverAClockThatWasSetBack) {
  const EditedRecording recording;
  const std::string set_back =
      recording.write("back.pcap", 0, kRecords, [](std::size_t i) { return i < 150 ? 3600 : 0; });
  const Finished finished = replay({set_back});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("300 packets, 0 rejected"));
  EXPECT_THAT(finished.err, HasSubstr("packet 151 (byte "));
  EXPECT_THAT(finished.err, HasSubstr("the clock was set back by 3"));
}

TEST(Field, ReplayAtASpeedDoesNotWaitForAClockThatWasSet) {
  const EditedRecording recording;
  const std::string forward = recording.write(
      "forward.pcap", 0, kRecords, [](std::size_t i) { return i < 150 ? 0 : 86400; });
  const Finished finished =
      RaylocProcess(
          {"replay", kSite, "ap1=" + forward, "--burst", "2s", "--speed", "100", "--max-gap", "1"})
          .wait();
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("300 packets, 0 rejected"));
  EXPECT_THAT(finished.err, HasSubstr("the clock was set, or nothing was received"));
}

// The records of a file, each with its header.
std::vector<std::string> records_of(const std::string& file) {
  std::vector<std::string> records;
  for (std::size_t at = kHeader; at < file.size();) {
    const std::size_t size = 16 + number_at(file, at + 8);
    records.push_back(file.substr(at, size));
    at += size;
  }
  return records;
}

TEST(Field, ReplayMakesNoFixOfAnotherChannelThanTheSites) {
  // Behind the headers of the record, Ethernet, IPv4 and UDP; then where AX-CSI has the chanspec.
  constexpr std::size_t kChanspec = 16 + 14 + 20 + 8 + 52;
  const std::string file = unpacked(kSite + "/device_los-ap1.pcap.gz");
  const EditedRecording recording;
  const auto with_channel = [&](const std::string& name, const char* chanspec, std::size_t from) {
    std::string edited = file.substr(0, kHeader);
    std::size_t number = 0;
    for (std::string record : records_of(file)) {
      if (number++ >= from) {
        record.replace(kChanspec, 2, chanspec, 2);
      }
      edited += record;
    }
    test::write_file(recording.folder() + "/" + name, edited);
    return recording.folder() + "/" + name;
  };
  for (const auto& [chanspec, channel] : {std::pair("\x97\xd9", "5755 MHz (40 MHz wide)"),
                                          std::pair("\x2a\xe0", "5210 MHz (80 MHz wide)")}) {
    const Finished finished = replay({with_channel("other.pcap", chanspec, 0)});
    EXPECT_EQ(finished.status, 65) << finished.err;
    EXPECT_THAT(finished.out, ::testing::IsEmpty());
    EXPECT_THAT(finished.err, HasSubstr(channel));
    EXPECT_THAT(finished.err, HasSubstr("5190 MHz (40 MHz wide)"));
    EXPECT_THAT(finished.err, HasSubstr("other_channel"));
  }
  const Finished hop = replay({with_channel("hop.pcap", "\x97\xd9", 300)});
  EXPECT_EQ(hop.status, 0) << hop.err;
  EXPECT_THAT(hop.err, HasSubstr("the channel changed at 2024-"));
}

TEST(Field, ReplayMakesNoFixOfSeveralAccessPointsInOneRecording) {
  std::vector<std::string> records;
  std::string mixture;
  for (const char* ap : {"ap1", "ap2"}) {
    const std::string file = unpacked(kSite + "/device_los-" + ap + ".pcap.gz");
    mixture = file.substr(0, kHeader);
    for (std::string& record : records_of(file)) {
      records.push_back(std::move(record));
    }
  }
  std::stable_sort(records.begin(), records.end(), [](const auto& a, const auto& b) {
    return std::pair(number_at(a, 0), number_at(a, 4)) <
           std::pair(number_at(b, 0), number_at(b, 4));
  });
  for (const std::string& record : records) {
    mixture += record;
  }
  const EditedRecording recording;
  const std::string file = recording.folder() + "/mixture.pcap";
  test::write_file(file, mixture);
  const Finished finished = replay({file});
  EXPECT_EQ(finished.status, 65) << finished.err;
  EXPECT_THAT(finished.out, ::testing::IsEmpty());
  EXPECT_THAT(finished.err, HasSubstr("several access points"));
  EXPECT_THAT(finished.err, HasSubstr("allow"));
}

TEST(Field, VerbsExplainACaptureInMonitorMode) {
  const EditedRecording recording;
  std::string air = test::pcap_header(test::Endian::kLittle, false, 127);
  for (std::uint32_t i = 0; i < 20; ++i) {
    air += test::pcap_record(test::Endian::kLittle, 1'718'001'352 + i, 0, std::string(66, '\0'));
  }
  const std::string file = recording.folder() + "/air.pcap";
  test::write_file(file, air);
  for (const Finished& finished : {replay({file}),
                                   RaylocProcess({"frames", file}).wait(),
                                   RaylocProcess({"calibrate",
                                                  kSite,
                                                  "--capture",
                                                  "ap1=" + file,
                                                  "--points",
                                                  kSite + "/calibration.csv",
                                                  "--out",
                                                  recording.folder() + "/out"})
                                       .wait()}) {
    EXPECT_EQ(finished.status, 65) << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("a capture in monitor mode"));
    EXPECT_THAT(finished.err, HasSubstr("udp port 5500"));
  }
}

}  // namespace
}  // namespace rayloc::field_recordings_verbs_test
