// Datagrams per second from a mapped file, on one core.
//
// BM_Memcpy, the baseline: each datagram's bytes copied once, nothing else.
#include <benchmark/benchmark.h>

#include <array>
#include <cstring>

#include "tests/bench/mapped_datagrams.h"

namespace rayloc::bench {
namespace {

constexpr std::size_t kDatagrams = 100'000;  // 57 MB at 128 tones

const MappedDatagrams& recording() {
  static const MappedDatagrams kRecording("axcsi-rt-ax86u/AllData.pcap", kDatagrams);
  return kRecording;
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
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(datagrams.size()));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(recording().bytes()));
}
BENCHMARK(BM_Memcpy)->Repetitions(5)->ReportAggregatesOnly()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rayloc::bench

BENCHMARK_MAIN();
