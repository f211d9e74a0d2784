// BestTimes: Google Benchmark's console output (the median of the repetitions), and the least times
// of each benchmark afterwards, so that a benchmark can be compared with its baseline of the same
// run. The least, since other programs on the machine only add time.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rayloc::bench {

// The times of one iteration [s].
struct BestTime {
  double wall = 0.0;
  double cpu = 0.0;  // of all threads
  std::map<std::string, double> counters;
};

class BestTimes final : public benchmark::ConsoleReporter {
 public:
  BestTimes() : ConsoleReporter(OO_None) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> shown;
    for (const Run& run : runs) {
      if (run.run_type == Run::RT_Iteration && !run.error_occurred) {
        keep(run);
      } else if (run.aggregate_name == "median" || run.error_occurred) {
        shown.push_back(run);
      }
    }
    ConsoleReporter::ReportRuns(shown);
  }

  // By the name given to BENCHMARK and its argument ("BM_ColdLink/143"); nothing if it did not run.
  std::optional<BestTime> find(const std::string& name) const {
    const auto found = best_.find(name);
    return found == best_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  void keep(const Run& run) {
    std::string name = run.run_name.function_name;
    if (!run.run_name.args.empty()) {
      name += "/" + run.run_name.args;
    }
    const auto iterations = static_cast<double>(run.iterations);
    const double wall = run.real_accumulated_time / iterations;
    const double cpu = run.cpu_accumulated_time / iterations;
    BestTime& best = best_.try_emplace(name, BestTime{wall, cpu, {}}).first->second;
    best.wall = std::min(best.wall, wall);
    best.cpu = std::min(best.cpu, cpu);
    for (const auto& [counter, value] : run.counters) {
      best.counters[counter] = value.value;
    }
  }

  std::map<std::string, BestTime> best_;
};

// main() of a benchmark; `print_summary` compares the times at the end.
inline int run_benchmarks(int argc, char** argv, void (*print_summary)(const BestTimes&)) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  BestTimes best;
  benchmark::RunSpecifiedBenchmarks(&best);
  print_summary(best);
  return 0;
}

}  // namespace rayloc::bench
