// Datagrams per second from a mapped file, on one core.
//
// BM_Memcpy, the baseline: each datagram's bytes copied once, nothing else.
// BM_Receive: each recognised, decoded, assembled and made a CsiFrame, as live.
// BM_Recognise, BM_Unpack: what the header and the CSI words alone cost.
// The last line is the ratio of the medians, of CPU time. Build with the release preset.
#include <benchmark/benchmark.h>

#include <array>
#include <complex>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/decode/decoder_registry.h"
#include "tests/bench/mapped_datagrams.h"
#include "tests/support/wire_writer.h"

namespace rayloc::bench {
namespace {

constexpr std::size_t kDatagrams = 100'000;  // 57 MB at 128 tones

constexpr int kFrames = 36;

test::Recording frames_of_four_rx_chains() {
  test::Recording recording;
  test::WireFrame frame;
  for (int i = 0; i < kFrames; ++i) {
    ++frame.sequence;
    frame.sequence_control = static_cast<std::uint16_t>(frame.sequence << 4);
    const auto one = test::write_axcsi(
        frame, Timestamp(std::chrono::seconds(1)) + i * std::chrono::milliseconds(50));
    recording.insert(recording.end(), one.begin(), one.end());
  }
  return recording;
}

const MappedDatagrams& recording() {
  static const MappedDatagrams kRecording(frames_of_four_rx_chains(), kDatagrams);
  return kRecording;
}

void count_datagrams(benchmark::State& state) {
  const auto& datagrams = recording().datagrams();
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(datagrams.size()));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(recording().bytes()));
}

void BM_Memcpy(benchmark::State& state) {
  const auto& datagrams = recording().datagrams();
  std::array<std::byte, 2048> copy{};
  for (auto _ : state) {
    for (const Datagram& datagram : datagrams) {
      std::memcpy(copy.data(), datagram.payload.data(), datagram.payload.size());
      benchmark::DoNotOptimize(copy.data());
      benchmark::ClobberMemory();
    }
  }
  count_datagrams(state);
}

void BM_Recognise(benchmark::State& state) {
  const DecoderRegistry registry("");
  for (auto _ : state) {
    for (const Datagram& datagram : recording().datagrams()) {
      benchmark::DoNotOptimize(registry.decode(datagram.payload));
    }
  }
  count_datagrams(state);
}

void BM_Unpack(benchmark::State& state) {
  std::vector<std::complex<float>> csi(128);
  for (auto _ : state) {
    for (const Datagram& datagram : recording().datagrams()) {
      unpack_csi_words(CsiWords::kFloat12, datagram.payload.last(4 * csi.size()), csi);
      benchmark::DoNotOptimize(csi.data());
      benchmark::ClobberMemory();
    }
  }
  count_datagrams(state);
}

void BM_Receive(benchmark::State& state) {
  std::vector<CsiFrame> frames;
  for (auto _ : state) {
    CsiReceiver receiver({});
    std::uint64_t emitted = 0;
    for (const Datagram& datagram : recording().datagrams()) {
      receiver.push(datagram, frames);
      emitted += frames.size();
      benchmark::DoNotOptimize(frames.data());
      frames.clear();
    }
    receiver.flush(frames);
    const CsiReceiverCounters counters = receiver.counters();
    if (counters.in_frames != recording().datagrams().size() || counters.partial != 0) {
      state.SkipWithError("datagrams were lost");
    }
    frames.clear();
    benchmark::DoNotOptimize(emitted);
  }
  count_datagrams(state);
}

void repeat(benchmark::internal::Benchmark* benchmark) {
  benchmark->Repetitions(7)->ReportAggregatesOnly()->Unit(benchmark::kMillisecond);
}
BENCHMARK(BM_Memcpy)->Apply(repeat);
BENCHMARK(BM_Recognise)->Apply(repeat);
BENCHMARK(BM_Unpack)->Apply(repeat);
BENCHMARK(BM_Receive)->Apply(repeat);

// Prints as the console does, and keeps the medians.
class MedianReporter final : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const auto rate = run.counters.find("items_per_second");
      if (run.aggregate_name == "median" && rate != run.counters.end()) {
        medians_[run.run_name.function_name] = rate->second.value;
      }
    }
    ConsoleReporter::ReportRuns(runs);
  }

  void print_ratio() const {
    const auto memcpy_rate = medians_.find("BM_Memcpy");
    const auto receive_rate = medians_.find("BM_Receive");
    if (memcpy_rate != medians_.end() && receive_rate != medians_.end()) {
      std::printf(
          "received: %.2f million datagrams/s a core; memcpy of the same bytes: %.1f times that\n",
          receive_rate->second / 1e6,
          memcpy_rate->second / receive_rate->second);
    }
  }

 private:
  std::map<std::string, double> medians_;
};

}  // namespace
}  // namespace rayloc::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  rayloc::bench::MedianReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_ratio();
}
