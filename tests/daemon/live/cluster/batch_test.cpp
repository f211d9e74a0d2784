#include "daemon/live/cluster/batch.h"

#include <functional>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"
#include "tests/daemon/live/cluster/some_batch.h"

namespace rayloc::batch_test {
namespace {

using ::testing::HasSubstr;

v1::CsiBatch message_of(const std::string& bytes) {
  v1::CsiBatch message;
  EXPECT_TRUE(unseal(bytes, message));
  return message;
}

std::string refusal(const std::string& bytes) {
  const Expected<Batch> batch = decode_batch(bytes);
  return batch ? "none" : batch.error().message;
}

TEST(Batch, ReadsBackEveryDatagramAndGap) {
  Batch batch = some_batch(7, {{"ap1", 3}, {"ap2", 2}, {"ap3", 0}});
  batch.parts[1].datagrams.entries[1].address.source_ip = 0x0a0a0a0b;
  batch.gaps = {{2, 3, {{"ap1", 12}}, "the broker was absent"}, {5, 5, {}, "not kept"}};
  batch.oldest_kept = 4;
  batch.clock_synchronised = true;
  const Expected<Batch> read = decode_batch(encode(batch));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(encode(*read), encode(batch));
  ASSERT_EQ(read->parts.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read->parts[i].access_point, batch.parts[i].access_point);
    EXPECT_EQ(read->parts[i].watermark, batch.parts[i].watermark);
    EXPECT_EQ(read->parts[i].datagrams.payloads, batch.parts[i].datagrams.payloads);
    const auto now = read->parts[i].datagrams.datagrams();
    const auto then = batch.parts[i].datagrams.datagrams();
    ASSERT_EQ(now.size(), then.size());
    for (std::size_t j = 0; j < now.size(); ++j) {
      EXPECT_EQ(now[j].time, then[j].time);
      EXPECT_EQ(now[j].address, then[j].address);
      EXPECT_EQ(now[j].payload.size(), then[j].payload.size());
    }
  }
  ASSERT_EQ(read->gaps.size(), 2U);
  EXPECT_EQ(read->gaps[0].datagrams.at("ap1"), 12U);
  EXPECT_EQ(read->gaps[1].reason, "not kept");
  EXPECT_EQ(read->oldest_kept, 4U);
  EXPECT_TRUE(read->clock_synchronised);
}

TEST(Batch, CostsFewBytesADatagram) {
  const Batch batch = some_batch(1, {{"ap1", 64}});
  EXPECT_LT(encode(batch).size() - batch.parts[0].datagrams.payloads.size(), 64U * 6U);
}

TEST(Batch, RefusesInvalidBytes) {
  EXPECT_THAT(refusal(""), HasSubstr("0 bytes that are no message of a cluster"));
  EXPECT_THAT(refusal("an honest word"), HasSubstr("no message of a cluster"));
}

TEST(Batch, RefusesAnotherVersionWithARemedy) {
  std::string bytes = encode(some_batch(1, {{"ap1", 1}}));
  bytes[3] = 2;
  EXPECT_THAT(refusal(bytes), HasSubstr("version 2, and this program reads version 1: run"));
}

TEST(Batch, RefusesEveryChangedByte) {
  const std::string bytes = encode(some_batch(1, {{"ap1", 2}}));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    EXPECT_NE(refusal(changed), "none") << "byte " << i;
    EXPECT_NE(refusal(bytes.substr(0, i)), "none") << i << " bytes";
  }
}

TEST(Batch, RefusesAMessageOfAnotherKind) {
  v1::GapMark mark;
  mark.set_from_number(1);
  mark.set_reason("a gap");
  EXPECT_NE(refusal(seal(mark)), "none");
}

TEST(Batch, RefusesNumbersThatContradictEachOther) {
  Batch batch = some_batch(5, {{"ap1", 2}});
  batch.gaps = {{2, 3, {}, "x"}};
  batch.parts[0].datagrams.entries[1].address.source_port = 1;
  const std::string good = encode(batch);
  const auto refused = [&](const std::function<void(v1::CsiBatch&)>& change) {
    v1::CsiBatch message = message_of(good);
    change(message);
    return refusal(seal(message));
  };
  EXPECT_EQ(refused([](auto&) {}), "none");
  EXPECT_THAT(refused([](auto& m) { m.set_number(0); }), HasSubstr("no number"));
  EXPECT_THAT(refused([](auto& m) { m.set_epoch(0); }), HasSubstr("no number"));
  EXPECT_THAT(refused([](auto& m) { m.mutable_parts(0)->set_size(0, 5); }),
              HasSubstr("batch 5: access point 'ap1': sizes that add up to"));
  EXPECT_THAT(refused([](auto& m) { m.mutable_parts(0)->set_size(0, 65'508); }),
              HasSubstr("a datagram of 65508 bytes"));
  EXPECT_THAT(refused([](auto& m) { m.mutable_parts(0)->add_size(0); }),
              HasSubstr("2 times, 3 sizes and 2 addresses"));
  EXPECT_THAT(refused([](auto& m) { m.mutable_parts(0)->set_address(0, 2); }),
              HasSubstr("address 2 of 2"));
  EXPECT_THAT(refused([](auto& m) {
                m.mutable_parts(0)->clear_address();
                m.mutable_parts(0)->clear_addresses();
              }),
              HasSubstr("without an address"));
  EXPECT_THAT(
      refused([](auto& m) { m.mutable_parts(0)->mutable_addresses(0)->set_source_port(65'536); }),
      HasSubstr("a port above 65535"));
  EXPECT_THAT(refused([](auto& m) { m.mutable_parts(0)->clear_access_point(); }),
              HasSubstr("without an access point"));
  EXPECT_THAT(refused([](auto& m) { m.mutable_gaps(0)->set_to_number(5); }),
              HasSubstr("a gap of numbers 2 to 5"));
  EXPECT_THAT(refused([](auto& m) { m.mutable_gaps(0)->set_from_number(0); }),
              HasSubstr("a gap of numbers 0 to 3"));
}

TEST(Batch, RefusesTimesOutOfRange) {
  const std::int64_t extreme = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t delta : {extreme, -extreme, -1'800'000'000'000'000}) {
    v1::CsiBatch message = message_of(encode(some_batch(1, {{"ap1", 1}})));
    message.mutable_parts(0)->set_time_delta_us(0, delta);
    EXPECT_THAT(refusal(seal(message)), HasSubstr("times before 1970 or after 2255"));
  }
}

}  // namespace
}  // namespace rayloc::batch_test
