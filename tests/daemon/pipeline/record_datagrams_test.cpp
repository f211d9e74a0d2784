// Tests the recording of one source: its limits, its end, and errors of the sink.
#include "daemon/pipeline/record/record_datagrams.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::record_datagrams_test {
namespace {

// Returns batches of three datagrams; ends after `batches`, by an Error if `breaks`.
class CountedSource final : public DatagramSource {
 public:
  explicit CountedSource(int batches, bool breaks = false) : batches_(batches), breaks_(breaks) {}

  Expected<void> read(DatagramBatch& batch, Duration /*timeout*/) override {
    if (breaks_ && reads_ == batches_) {
      return make_error(ErrorKind::kUnavailable, "the interface is gone");
    }
    ++reads_;
    batch.datagrams.assign(3, Datagram{});
    batch.ended = !breaks_ && reads_ == batches_;
    counters_.received += 3;
    return {};
  }
  SourceCounters counters() const override { return counters_; }
  std::string description() const override { return "counted"; }
  int reads() const { return reads_; }

 private:
  int batches_;
  bool breaks_;
  int reads_ = 0;
  SourceCounters counters_;
};

class CountingSink final : public DatagramSink {
 public:
  Expected<void> write(const DatagramBatch& batch) override {
    counters_.given += batch.datagrams.size();
    if (is_full) {
      counters_.lost_by["not_written"] += batch.datagrams.size();
      return make_error(ErrorKind::kUnavailable, "no space left");
    }
    counters_.delivered += batch.datagrams.size();
    return {};
  }
  void note_source(const SourceCounters& source) override { noted = source.received; }
  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override { return "counting"; }

  bool is_full = false;
  std::uint64_t noted = 0;

 private:
  SinkCounters counters_;
};

struct Result {
  Expected<void> outcome;
  std::vector<std::string> errors = {};
};

Result record(
    CountedSource& source,
    CountingSink& sink,
    const DatagramLimits& limits,
    const std::function<bool()>& is_stopped = [] { return false; }) {
  std::vector<std::string> errors;
  auto outcome = record_datagrams(source, sink, limits, {is_stopped, [&](const Error& error) {
                                                           errors.push_back(error.message);
                                                         }});
  return {std::move(outcome), std::move(errors)};
}

TEST(RecordDatagrams, ToTheEndOfTheSource) {
  CountedSource source(4);
  CountingSink sink;
  EXPECT_TRUE(record(source, sink, {}).outcome);
  EXPECT_EQ(sink.counters().delivered, 12U);
  EXPECT_EQ(sink.noted, 12U);
}

TEST(RecordDatagrams, NoMoreThanTheCount) {
  CountedSource source(1000);
  CountingSink sink;
  EXPECT_TRUE(record(source, sink, {.count = 7}).outcome);
  EXPECT_EQ(sink.counters().given, 7U);
  EXPECT_EQ(source.reads(), 3);
}

TEST(RecordDatagrams, UntilItIsStoppedOrItsTimeIsOver) {
  CountedSource source(1'000'000'000);
  CountingSink sink;
  EXPECT_TRUE(record(source, sink, {}, [&] { return source.reads() == 2; }).outcome);
  EXPECT_EQ(sink.counters().given, 6U);
  EXPECT_TRUE(record(source, sink, {.duration = 0.01}).outcome);
  EXPECT_LT(source.reads(), 1'000'000'000);
}

TEST(RecordDatagrams, AFullSinkIsReportedOnceAndEndsNothing) {
  CountedSource source(5);
  CountingSink sink;
  sink.is_full = true;
  const Result result = record(source, sink, {});
  EXPECT_TRUE(result.outcome);
  EXPECT_EQ(result.errors, std::vector<std::string>{"no space left"});
  EXPECT_EQ(sink.counters().lost(), 15U);
}

TEST(RecordDatagrams, AnErrorOfTheSourceEndsIt) {
  CountedSource source(2, true);
  CountingSink sink;
  const Result result = record(source, sink, {});
  ASSERT_FALSE(result.outcome);
  EXPECT_EQ(result.outcome.error().message, "the interface is gone");
  EXPECT_EQ(sink.counters().delivered, 6U);
}

}  // namespace
}  // namespace rayloc::record_datagrams_test
