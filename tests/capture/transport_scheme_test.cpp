// The table of transports: how its rows are found, and that a new transport is one row.
#include "capture/transport/transport_scheme.h"

#include <unistd.h>

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/source/transport_schemes.h"
#include "capture/transport/sink_queue.h"

namespace rayloc::transport_scheme_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// A transport that exists in this file only: what is sent to a name is read by that name.
struct Kept {
  Timestamp time;
  std::string payload;
};
std::map<std::string, std::vector<Kept>>& memory() {
  static std::map<std::string, std::vector<Kept>> kept;
  return kept;
}

class MemorySource final : public DatagramSource {
 public:
  explicit MemorySource(std::string name) : name_(std::move(name)) {}
  Expected<void> read(DatagramBatch& batch, Duration /*timeout*/) override {
    batch = {};
    for (const Kept& one : memory()[name_]) {
      batch.datagrams.push_back({one.time, {}, std::as_bytes(std::span(one.payload))});
      counters_.bytes += one.payload.size();
    }
    counters_.delivered = counters_.received = batch.datagrams.size();
    batch.ended = true;
    return {};
  }
  SourceCounters counters() const override { return counters_; }
  std::string description() const override { return "memory " + name_; }

 private:
  std::string name_;
  SourceCounters counters_;
};

class MemorySink final : public DatagramSink {
 public:
  explicit MemorySink(std::string name) : name_(std::move(name)) {}
  Expected<void> write(const DatagramBatch& batch) override {
    for (const Datagram& one : batch.datagrams) {
      const auto* bytes = reinterpret_cast<const char*>(one.payload.data());
      memory()[name_].push_back({one.time, {bytes, one.payload.size()}});
      ++counters_.given;
      ++counters_.delivered;
    }
    return {};
  }
  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override { return "memory " + name_; }

 private:
  std::string name_;
  SinkCounters counters_;
};

// The one row.
constexpr TransportScheme kMemory{
    .name = "memory",
    .address = "NAME",
    .example = "memory:lab",
    .summary = "a place in this process",
    .live = false,
    .open_source = [](const std::string& address, const SourceOptions& /*options*/)
        -> Expected<std::unique_ptr<DatagramSource>> {
      return std::make_unique<MemorySource>(address);
    },
    .open_sink = [](const std::string& address) -> Expected<std::unique_ptr<DatagramSink>> {
      return std::make_unique<MemorySink>(address);
    },
};

std::vector<TransportScheme> with_memory() {
  const TransportTable table = transport_schemes();
  std::vector<TransportScheme> rows(table.begin(), table.end());
  rows.push_back(kMemory);
  return rows;
}

Datagram datagram(const std::string& text, int microseconds) {
  return {Timestamp(std::chrono::seconds(1000) + std::chrono::microseconds(microseconds)),
          {},
          std::as_bytes(std::span(text))};
}

// Returns the texts of all datagrams up to the end of the source.
std::vector<std::string> read_all(DatagramSource& source) {
  std::vector<std::string> texts;
  DatagramBatch batch;
  while (!batch.ended) {
    const auto read = source.read(batch, std::chrono::milliseconds(100));
    EXPECT_TRUE(read) << read.error().message;
    for (const Datagram& one : batch.datagrams) {
      texts.emplace_back(reinterpret_cast<const char*>(one.payload.data()), one.payload.size());
    }
    if (!read) {
      break;
    }
  }
  return texts;
}

// By the functions that raylocd, survey, record, send and rayloc-capture call, next to a file.
TEST(TransportScheme, ARowOfTheTableDefinesATransport) {
  const std::vector<TransportScheme> table = with_memory();
  const std::string file = (std::filesystem::temp_directory_path() /
                            ("transport_scheme_test_" + std::to_string(getpid()) + ".pcap"))
                               .string();
  std::filesystem::remove(file);
  std::vector<std::unique_ptr<DatagramSink>> sinks;
  for (const std::string& text : {std::string("memory:lab"), "pcap:" + file}) {
    auto sink = open_datagram_sink(table, text, "udp");
    ASSERT_TRUE(sink) << sink.error().message;
    sinks.push_back(*std::move(sink));
  }
  SinkQueue queue(std::move(sinks));
  const std::string one = "one";
  const std::string two = "two";
  for (std::size_t sink : {0U, 1U}) {
    ASSERT_TRUE(queue.queue(sink, datagram(one, 0)));
    ASSERT_TRUE(queue.queue(sink, datagram(two, 5)));
  }
  EXPECT_EQ(queue.counters().given, 0U) << "they wait for one another";
  ASSERT_TRUE(queue.sync());
  EXPECT_EQ(queue.counters().delivered, 4U);

  for (const std::string& text : {std::string("memory:lab"), file}) {
    auto source = open_datagram_source(table, text, "pcap");
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_THAT(read_all(**source), ElementsAre("one", "two")) << text;
  }
  std::filesystem::remove(file);
  EXPECT_THAT(transport_syntax(table, TransportUse::kSource), HasSubstr("memory:NAME"));
  EXPECT_THAT(transport_syntax(table, TransportUse::kSink), HasSubstr("memory:NAME"));
  EXPECT_THAT(transport_syntax(table, TransportUse::kLiveSource), Not(HasSubstr("memory")));
}

TEST(TransportScheme, TheRowsAreComplete) {
  std::set<std::string_view> names;
  for (const TransportScheme& row : transport_schemes()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_NE(row.open_source == nullptr && row.open_sink == nullptr, true) << row.name;
    EXPECT_FALSE(row.summary.empty()) << row.name;
    const auto parsed = parse_transport(transport_schemes(), std::string(row.example));
    ASSERT_TRUE(parsed) << parsed.error().message;
    EXPECT_EQ(parsed->scheme->name, row.name);
    EXPECT_FALSE(parsed->address.empty());
  }
}

TEST(TransportScheme, PlainFormsKeepTheirMeaning) {
  struct Case {
    const char* text;
    const char* plain;
    const char* scheme;
    const char* address;
  };
  for (const Case& c : {Case{"0.0.0.0:5500", "udp", "udp", "0.0.0.0:5500"},
                        Case{"*:5500", "udp", "udp", "*:5500"},
                        Case{":5500", "udp", "udp", ":5500"},
                        Case{"localhost:5500", "udp", "udp", "localhost:5500"},
                        Case{"udp:localhost:5500", "udp", "udp", "localhost:5500"},
                        Case{"udp:0.0.0.0:5500", "", "udp", "0.0.0.0:5500"},
                        Case{"ring-12:05.pcap", "pcap", "pcap", "ring-12:05.pcap"},
                        Case{"./udp:5.pcap", "pcap", "pcap", "./udp:5.pcap"},
                        Case{"-", "pcap", "pcap", "-"},
                        Case{"pcap:a.pcap", "udp", "pcap", "a.pcap"},
                        Case{"/run/raylocd/eth0", "unix", "unix", "/run/raylocd/eth0"}}) {
    const auto parsed = parse_transport(transport_schemes(), c.text, c.plain);
    ASSERT_TRUE(parsed) << c.text << parsed.error().message;
    EXPECT_EQ(parsed->scheme->name, c.scheme) << c.text;
    EXPECT_EQ(parsed->address, c.address) << c.text;
  }
}

TEST(TransportScheme, AnUnknownTransportListsTheKnownOnes) {
  const auto sink = open_datagram_sink(transport_schemes(), "nats:lab", "udp");
  ASSERT_FALSE(sink);
  EXPECT_EQ(sink.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(sink.error().message,
              HasSubstr("write HOST:PORT, for example 127.0.0.1:5500; 'nats' is no transport "
                        "either; there are: udp, pcap, unix, live"));
  const auto source = open_datagram_source(transport_schemes(), "upd:0.0.0.0:5500");
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(source.error().message, HasSubstr("did you mean 'udp'?"));
}

TEST(TransportScheme, RefusesToSendToReceiveOnlyTransports) {
  const auto sink = open_datagram_sink(transport_schemes(), "live:eth0");
  ASSERT_FALSE(sink);
  EXPECT_EQ(sink.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(sink.error().message, HasSubstr("there are: udp:HOST:PORT, pcap:FILE or unix:PATH"));
}

}  // namespace
}  // namespace rayloc::transport_scheme_test
