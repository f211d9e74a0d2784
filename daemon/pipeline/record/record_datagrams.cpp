#include "daemon/pipeline/record/record_datagrams.h"

#include <algorithm>
#include <chrono>

namespace rayloc {
namespace {

using RecordingClock = std::chrono::steady_clock;

// Passes on an error at once, then every ten seconds while it persists.
class WriteErrors {
 public:
  explicit WriteErrors(const std::function<void(const Error&)>& report) : report_(report) {}

  void add(const Error& error) {
    const auto now = RecordingClock::now();
    if (now >= next_) {
      next_ = now + std::chrono::seconds(10);
      report_(error);
    }
  }

 private:
  const std::function<void(const Error&)>& report_;
  RecordingClock::time_point next_ = RecordingClock::time_point::min();  // of the next report
};

}  // namespace

Expected<void> record_datagrams(DatagramSource& source,
                                DatagramSink& sink,
                                const DatagramLimits& limits,
                                const RecordEvents& events) {
  constexpr Duration kTick = std::chrono::milliseconds(100);
  const auto begin = RecordingClock::now();
  const std::uint64_t limit = limits.count.value_or(UINT64_MAX);
  DatagramBatch batch;
  WriteErrors errors(events.on_write_error);
  while (!events.is_stopped() && !batch.ended && sink.counters().given < limit) {
    Duration wait = kTick;
    if (limits.duration) {
      const Duration left = from_seconds(*limits.duration) - (RecordingClock::now() - begin);
      if (left <= Duration::zero()) {
        break;
      }
      wait = std::min(wait, left);
    }
    RAYLOC_TRY(source.read(batch, wait));
    const std::uint64_t room = limit - sink.counters().given;
    const auto taken = std::min<std::uint64_t>(room, batch.datagrams.size());
    batch.datagrams.resize(taken);
    sink.note_source(source.counters());
    if (auto written = sink.write(batch); !written) {
      errors.add(written.error());
    }
  }
  return {};
}

}  // namespace rayloc
