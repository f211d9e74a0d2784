// Tests the log of the Intel 5300's CSI tool: as a file, record by record, and the content of a
// record. The records are written here bit by bit, from the published layout; no code is shared
// with the reader.
#include <unistd.h>

#include <array>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/csi_receiver.h"
#include "capture/decode/intel5300_decoder.h"
#include "capture/source/recorded_source.h"
#include "tests/support/test_paths.h"

namespace rayloc::intel5300_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Bytes = std::string;

void put(Bytes& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
  }
}

struct Card {
  int chains = 3;
  int streams = 1;
  std::array<int, 3> antenna = {0, 1, 2};  // of each chain
  bool wide = true;
  bool extended = false;
  std::uint32_t clock = 5'000'000;  // [us]
  std::uint16_t count = 7;
};

// The value that the card reports for a chain, stream and group of tones: any byte occurs.
std::pair<int, int> value_of(int chain, int stream, int group) {
  return {(37 * chain + 11 * stream + 5 * group) % 256 - 128,
          (91 * chain + 29 * stream + 13 * group) % 256 - 128};
}

Bytes csi_of(const Card& card) {
  std::vector<bool> bits;
  const auto append = [&](int value, int count) {
    for (int i = 0; i < count; ++i) {
      bits.push_back((static_cast<unsigned>(value) >> static_cast<unsigned>(i) & 1U) != 0);
    }
  };
  for (int group = 0; group < 30; ++group) {
    append(5, 3);
    for (int chain = 0; chain < card.chains; ++chain) {
      for (int stream = 0; stream < card.streams; ++stream) {
        const auto [real, imaginary] = value_of(chain, stream, group);
        append(real, 8);
        append(imaginary, 8);
      }
    }
  }
  Bytes bytes((bits.size() + 7) / 8, '\0');
  for (std::size_t i = 0; i < bits.size(); ++i) {
    bytes[i / 8] = static_cast<char>(static_cast<unsigned char>(bytes[i / 8]) |
                                     (bits[i] ? 1U << (i % 8) : 0U));
  }
  return bytes;
}

// From the code on.
Bytes record_of(const Card& card) {
  const Bytes csi = csi_of(card);
  Bytes bytes;
  put(bytes, 0xbb, 1);
  put(bytes, card.clock, 4);
  put(bytes, card.count, 2);
  put(bytes, 0, 2);
  put(bytes, static_cast<std::uint64_t>(card.chains), 1);
  put(bytes, static_cast<std::uint64_t>(card.streams), 1);
  put(bytes, 40, 1);
  put(bytes, 39, 1);
  put(bytes, 0, 1);
  put(bytes, 0x81, 1);  // noise: -127
  put(bytes, 30, 1);
  put(bytes,
      static_cast<std::uint64_t>(card.antenna[0] | card.antenna[1] << 2 | card.antenna[2] << 4),
      1);
  put(bytes, csi.size(), 2);
  put(bytes, card.wide ? 0x0901 : 0x0101, 2);
  if (card.extended) {
    put(bytes, 1'624'839'918, 4);
    put(bytes, 250'000, 4);
    for (const int octet : {0x00, 0x21, 0x6a, 0x30, 0xd2, 0x3c}) {
      put(bytes, static_cast<std::uint64_t>(octet), 1);
    }
    put(bytes, 1, 4);
  }
  return bytes + csi;
}

Bytes logged(const Bytes& record) {
  Bytes bytes;
  bytes.push_back(static_cast<char>(record.size() >> 8U));
  bytes.push_back(static_cast<char>(record.size() & 0xffU));
  return bytes + record;
}

Bytes copy_of_a_frame() { return logged("\xc1" + Bytes(128, 'f')); }

std::span<const std::byte> view(const Bytes& bytes) {
  return std::as_bytes(std::span(bytes.data(), bytes.size()));
}

struct Read {
  std::vector<CsiFrame> frames;
  SourceCounters source;
  CsiReceiverCounters receiver;
  std::vector<std::string> warnings;
  std::string error;
};

Read read_file(const std::string& file) {
  Read all;
  auto source = RecordedSource::open({file});
  if (!source) {
    all.error = source.error().message;
    return all;
  }
  CsiReceiver receiver({});
  DatagramBatch batch;
  while (!batch.ended) {
    if (const auto read = (*source)->read(batch, std::chrono::seconds(1)); !read) {
      all.error = read.error().message;
      break;
    }
    for (const Datagram& datagram : batch.datagrams) {
      receiver.push(datagram, all.frames);
    }
  }
  receiver.flush(all.frames);
  all.source = (*source)->counters();
  all.receiver = receiver.counters();
  all.warnings = (*source)->notices();
  const std::vector<std::string> later = (*source)->warnings();
  all.warnings.insert(all.warnings.end(), later.begin(), later.end());
  return all;
}

Read read_log(const Bytes& bytes) {
  // The name has the process id: other processes run tests of this file at the same time.
  const std::string file =
      ::testing::TempDir() + "/intel5300_" + std::to_string(::getpid()) + ".dat";
  std::ofstream(file, std::ios::binary) << bytes;
  Read read = read_file(file);
  std::filesystem::remove(file);
  return read;
}

TEST(Intel5300, GivesEveryValueOfARecord) {
  const Intel5300Decoder decoder;
  for (const int streams : {1, 2, 3}) {
    for (const int chains : {1, 2, 3}) {
      Card card;
      card.chains = chains;
      card.streams = streams;
      card.wide = false;
      const Bytes record = record_of(card);
      const auto frame = decoder.decode(view(record));
      ASSERT_TRUE(frame) << to_string(frame.error());
      EXPECT_EQ(frame->csi.antennas(), static_cast<std::size_t>(chains));
      EXPECT_EQ(frame->csi.streams(), static_cast<std::size_t>(streams));
      EXPECT_EQ(frame->transmitted_streams, streams);
      for (int chain = 0; chain < chains; ++chain) {
        for (int stream = 0; stream < streams; ++stream) {
          const auto row =
              frame->csi.row(static_cast<std::size_t>(chain), static_cast<std::size_t>(stream));
          for (int group = 0; group < 30; ++group) {
            const auto [real, imaginary] = value_of(chain, stream, group);
            EXPECT_EQ(row[static_cast<std::size_t>(group)],
                      std::complex<float>(static_cast<float>(real), static_cast<float>(imaginary)));
          }
        }
      }
    }
  }
}

TEST(Intel5300, NamesTonesCoresAndPowers) {
  Card card;
  card.wide = false;
  const auto narrow = Intel5300Decoder().decode(view(record_of(card)));
  ASSERT_TRUE(narrow);
  EXPECT_EQ(narrow->bandwidth_mhz, 20);
  EXPECT_EQ(narrow->phy, PhyFormat::kHt);
  EXPECT_EQ(narrow->tone_index.front(), -28);
  EXPECT_EQ(narrow->tone_index[13], -2);
  EXPECT_EQ(narrow->tone_index[14], -1);
  EXPECT_EQ(narrow->tone_index[15], 1);
  EXPECT_EQ(narrow->tone_index.back(), 28);
  EXPECT_EQ(narrow->sequence, 7);
  EXPECT_THAT(narrow->rx_chains, ElementsAre(0, 1, 2));
  // RSSI less 44 less the gain of 30; antenna C is not used.
  EXPECT_THAT(narrow->power_dbm,
              ElementsAre(std::optional(-34.0F), std::optional(-35.0F), std::nullopt));
  EXPECT_TRUE(narrow->complete);
}

// The upper half of a 40 MHz frame is sent a quarter of a turn ahead, and the card leaves it so.
TEST(Intel5300, UndoesTheRotationOfWideFrames) {
  const auto wide = Intel5300Decoder().decode(view(record_of({})));
  ASSERT_TRUE(wide);
  EXPECT_EQ(wide->bandwidth_mhz, 40);
  EXPECT_EQ(wide->tone_index.front(), -58);
  EXPECT_EQ(wide->tone_index[14], -2);
  EXPECT_EQ(wide->tone_index[15], 2);
  const auto row = wide->csi.row(1, 0);
  const auto value = [](int group) {
    const auto [real, imaginary] = value_of(1, 0, group);
    return std::complex<float>(static_cast<float>(real), static_cast<float>(imaginary));
  };
  EXPECT_EQ(row[14], value(14));
  EXPECT_EQ(row[15], value(15) * std::complex<float>(0, -1));
}

TEST(Intel5300, PutsChainsInTheOrderOfTheirAntennas) {
  Card card;
  card.wide = false;
  card.antenna = {2, 0, 1};
  const auto frame = Intel5300Decoder().decode(view(record_of(card)));
  ASSERT_TRUE(frame);
  EXPECT_THAT(frame->rx_chains, ElementsAre(0, 1, 2));
  const auto real = [&](std::size_t rx_chain) { return frame->csi.row(rx_chain, 0)[3].real(); };
  EXPECT_EQ(real(0), static_cast<float>(value_of(1, 0, 3).first));
  EXPECT_EQ(real(1), static_cast<float>(value_of(2, 0, 3).first));
  EXPECT_EQ(real(2), static_cast<float>(value_of(0, 0, 3).first));
  card.chains = 2;
  EXPECT_THAT(Intel5300Decoder().decode(view(record_of(card)))->rx_chains, ElementsAre(0, 2));
}

TEST(Intel5300, RefusesInvalidRecords) {
  const Intel5300Decoder decoder;
  const auto refusal = [&](const Bytes& bytes) {
    const auto frame = decoder.decode(view(bytes));
    return frame ? std::string("taken") : std::string(to_string(frame.error()));
  };
  const Bytes good = record_of({});
  EXPECT_EQ(refusal(good), "taken");
  EXPECT_EQ(refusal(""), "too_short");
  EXPECT_EQ(refusal(good.substr(0, 20)), "too_short");
  EXPECT_EQ(refusal(good.substr(0, good.size() - 1)), "length_mismatch");
  EXPECT_EQ(refusal(good + "x"), "length_mismatch");
  const auto changed = [&](std::size_t at, char value) {
    Bytes bytes = good;
    bytes[at] = value;
    return refusal(bytes);
  };
  EXPECT_EQ(changed(0, '\xc1'), "bad_magic");
  EXPECT_EQ(changed(9, 4), "core_range");
  EXPECT_EQ(changed(9, 0), "core_range");
  EXPECT_EQ(changed(10, 0), "stream_range");
  EXPECT_EQ(changed(10, 2), "length_mismatch");
  EXPECT_EQ(changed(16, 0), "antenna_permutation") << "three chains at one antenna";
  EXPECT_EQ(changed(20, 0), "legacy_rate") << "no HT frame";
  // Every prefix of a record is refused.
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_NE(refusal(good.substr(0, size)), "taken");
  }
}

TEST(Intel5300, IsReadAsARecording) {
  Card second;
  second.clock = 5'010'000;
  second.count = 8;
  const Read read = read_log(copy_of_a_frame() + logged(record_of({})) + copy_of_a_frame() +
                             logged(record_of(second)));
  EXPECT_EQ(read.error, "");
  ASSERT_EQ(read.frames.size(), 2U);
  EXPECT_EQ(read.frames[0].format, "intel-5300");
  EXPECT_EQ(read.frames[0].time, Timestamp(std::chrono::microseconds(5'000'000)));
  EXPECT_EQ(read.frames[1].time, Timestamp(std::chrono::microseconds(5'010'000)));
  EXPECT_EQ(read.frames[1].sequence, 8);
  EXPECT_EQ(read.source.received, 2U);
  EXPECT_EQ(read.source.delivered, 2U);
  EXPECT_EQ(read.receiver.in_frames, 2U);
}

TEST(Intel5300, ReadsBothHeaderLengths) {
  Card card;
  card.extended = true;
  const Read read = read_log(logged(record_of(card)));
  ASSERT_EQ(read.frames.size(), 1U);
  EXPECT_EQ(to_string(read.frames[0].transmitter), "00:21:6a:30:d2:3c");
  EXPECT_EQ(read.frames[0].time,
            Timestamp(std::chrono::seconds(1'624'839'918) + std::chrono::milliseconds(250)));
  EXPECT_EQ(to_string(read_log(logged(record_of({}))).frames.at(0).transmitter),
            "00:00:00:00:00:00");
}

TEST(Intel5300, CountsOnWhereTheCardsClockOverflows) {
  Card before;
  before.clock = 0xffffff00;
  Card after;
  after.clock = 0x100;
  const Read read = read_log(logged(record_of(before)) + logged(record_of(after)));
  ASSERT_EQ(read.frames.size(), 2U);
  EXPECT_EQ(read.frames[1].time - read.frames[0].time, std::chrono::microseconds(0x200));
}

TEST(Intel5300, ReportsThePositionOfDamageInALog) {
  const Bytes good = logged(record_of({}));
  const Read torn = read_log(good + good.substr(0, 100));
  EXPECT_EQ(torn.frames.size(), 1U);
  EXPECT_EQ(torn.source.rejected.at("torn_record"), 1U);
  ASSERT_EQ(torn.warnings.size(), 1U);
  EXPECT_THAT(torn.warnings[0],
              HasSubstr("byte " + std::to_string(good.size()) +
                        ": the last record is torn: 100 bytes of it are there"));
  Bytes wrong_code = good + good;
  wrong_code[good.size() + 2] = 0x11;
  EXPECT_THAT(
      read_log(wrong_code).error,
      HasSubstr("byte " + std::to_string(good.size()) + ": a record of an Intel 5300 log claims " +
                std::to_string(good.size() - 2) + " bytes and the code 17"));
  EXPECT_THAT(read_log(good + Bytes(8, '\0') + Bytes(8, 'x')).error, HasSubstr("claims 0 bytes"));
  EXPECT_THAT(read_log(good.substr(0, 60)).error, HasSubstr("nothing can be read"));
  EXPECT_THAT(read_log(good.substr(0, 9)).error, HasSubstr("before it is known to be a capture"));
  Bytes five_chains = good;
  five_chains[11] = 5;
  EXPECT_THAT(read_log(five_chains).error, HasSubstr("not a pcap, pcapng or gzip file"));
}

TEST(Field, AHealthyLogCausesNoClockWarning) {
  Card second;
  second.clock = 5'010'000;
  const Bytes healthy = logged(record_of({})) + logged(record_of(second));
  EXPECT_THAT(read_log(healthy).warnings, ::testing::IsEmpty());
  Card anew;  // the counter of a card that was started anew
  anew.clock = 1000;
  Bytes log;
  for (int i = 0; i < 4; ++i) {
    log += healthy;
  }
  for (int i = 0; i < 4; ++i) {
    log += logged(record_of(anew));
  }
  for (const std::string& line : read_log(log).warnings) {
    EXPECT_THAT(line, ::testing::Not(HasSubstr("clock was")));
  }
}

TEST(Field, ARecordWithoutAPermutationOfAntennasIsNamed) {
  Card wrong;
  wrong.antenna = {0, 0, 1};
  const Read read = read_log(logged(record_of({})) + logged(record_of(wrong)));
  EXPECT_EQ(read.frames.size(), 1U);
  EXPECT_EQ(read.receiver.rejected.at("antenna_permutation"), 1U);
  // Also where no record before it shows the format.
  EXPECT_EQ(read_log(logged(record_of(wrong))).receiver.rejected.count("antenna_permutation"), 1U);
}

// A single chain needs no permutation; its antenna is the one with power.
TEST(Field, ASingleChainWithoutAnAntennaFieldIsRead) {
  Card card;
  card.chains = 1;
  card.antenna = {3, 3, 3};
  Bytes record = record_of(card);
  record[11] = '\0';
  record[12] = '\x28';
  record[13] = '\0';
  const Read read = read_log(logged(record));
  ASSERT_EQ(read.frames.size(), 1U);
  EXPECT_THAT(read.frames[0].rx_chains, ElementsAre(1));
  EXPECT_EQ(read_log(logged(record_of(card))).receiver.rejected.count("antenna_permutation"), 1U);
}

TEST(Field, ARecordAtALegacyRateIsNamed) {
  Bytes record = record_of({});
  record[20] = '\0';
  const Read read = read_log(logged(record));
  EXPECT_TRUE(read.frames.empty());
  EXPECT_EQ(read.receiver.rejected.at("legacy_rate"), 1U);
}

TEST(Field, OtherNotificationsOfTheCardArePassedOver) {
  const Bytes noise = logged("\xd0" + Bytes(20, 'n'));
  const Read read = read_log(logged(record_of({})) + noise + logged(record_of({})));
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.source.delivered, 2U);
}

TEST(Field, ALateRecordAcrossTheOverflowDoesNotWrapTheCounterAgain) {
  std::vector<Card> cards(3);
  cards[0].clock = 0xffffff00;
  cards[1].clock = 0x100;
  cards[2].clock = 0xffffff80;
  Bytes log;
  for (const Card& card : cards) {
    log += logged(record_of(card));
  }
  const Read read = read_log(log);
  ASSERT_EQ(read.frames.size(), 3U);
  for (const CsiFrame& frame : read.frames) {
    EXPECT_LT(std::chrono::abs(frame.time - read.frames[0].time), std::chrono::seconds(1));
  }
}

// Recordings that other people made with such cards; they are no part of this checkout.
class RealIntel5300 : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* stated = std::getenv("RAYLOC_REAL_DATA");
    folder_ = stated != nullptr ? stated : test::source_path("/../shared/realdata");
    if (!std::filesystem::is_directory(folder_)) {
      GTEST_SKIP() << "no recordings of other people here: set RAYLOC_REAL_DATA";
    }
  }
  // Mean phase from the tone before to tone `k` of the first chain, all frames of that bandwidth.
  static double step(const Read& read, int bandwidth, std::size_t k) {
    std::complex<double> sum;
    for (const CsiFrame& frame : read.frames) {
      if (frame.bandwidth_mhz == bandwidth) {
        const auto row = frame.csi.row(1, 0);
        const std::complex<double> rotated(row[k] * std::conj(row[k - 1]));
        sum += rotated / std::max(std::abs(rotated), 1e-9);
      }
    }
    return std::arg(sum);
  }

  std::string folder_;
};

TEST_F(RealIntel5300, IsReadWholeAtTwentyMegahertz) {
  const Read read = read_file(folder_ + "/lgtm_intel5300_mit/1m_p0deg_laptop2_test1.dat");
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.frames.size(), 200U);
  EXPECT_TRUE(read.receiver.rejected.empty());
  // Delays are positive in our sign, and a step of one tone turns half of what two do.
  EXPECT_NEAR(step(read, 20, 10), -0.8, 0.15);
  EXPECT_NEAR(step(read, 20, 14), 0.5 * step(read, 20, 13), 0.06);
}

TEST_F(RealIntel5300, HasNoStepAcrossTheCentreAtFortyMegahertz) {
  const Read read = read_file(folder_ + "/ivanet_polyu_mit/d10_p02_l04.dat");
  EXPECT_EQ(read.frames.size(), 40U);
  const double beside = 0.5 * (step(read, 40, 14) + step(read, 40, 16));
  EXPECT_NEAR(std::remainder(step(read, 40, 15) - beside, 2.0 * std::numbers::pi), 0.0, 0.2);
}

TEST_F(RealIntel5300, ReadsTheExtendedHeaderToTheTornEnd) {
  const Read read = read_file(folder_ + "/wsr_toolbox_bsd2/csi_rx_2021-06-27_202550.dat");
  EXPECT_EQ(read.frames.size(), 4640U);
  EXPECT_EQ(read.source.rejected.at("torn_record"), 1U);
  EXPECT_EQ(to_string(read.frames[0].transmitter), "00:21:6a:30:d2:3c");
}

}  // namespace
}  // namespace rayloc::intel5300_test
