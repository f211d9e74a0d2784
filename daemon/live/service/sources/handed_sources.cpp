#include "daemon/live/service/sources/handed_sources.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "daemon/live/config/source_url.h"

namespace rayloc {
namespace {

// True if both would open the same source: names of sockets of systemd are by instance.
bool is_same(const SourceConfig& one, const SourceConfig& other) {
  return one.instance == other.instance && one.kind == other.kind &&
         source_url(one) == source_url(other) && one.only_interface == other.only_interface &&
         one.allow == other.allow && one.filter == other.filter;
}

SourceCounters since(const SourceCounters& before, SourceCounters now) {
  now.received -= before.received;
  now.delivered -= before.delivered;
  now.bytes -= before.bytes;
  now.kernel_drops -= before.kernel_drops;
  now.clock_steps -= before.clock_steps;
  now.unrecorded -= before.unrecorded;
  now.failures -= before.failures;
  for (const auto& [reason, count] : before.rejected) {
    now.rejected[reason] -= count;
  }
  std::erase_if(now.rejected, [](const auto& one) { return one.second == 0; });
  return now;
}

// A source that another site runtime has read before.
class ContinuedSource final : public DatagramSource {
 public:
  ContinuedSource(std::unique_ptr<DatagramSource> source, SourceCounters before)
      : source_(std::move(source)), before_(std::move(before)) {}

  Expected<void> read(DatagramBatch& batch, Duration timeout) override {
    return source_->read(batch, timeout);
  }
  SourceCounters counters() const override { return since(before_, source_->counters()); }
  std::string description() const override { return source_->description(); }
  ReceiveBuffer receive_buffer() const override { return source_->receive_buffer(); }
  std::vector<std::string> notices() const override { return source_->notices(); }
  std::vector<std::string> warnings() const override { return source_->warnings(); }
  std::string trouble() const override { return source_->trouble(); }
  std::optional<int> poll_descriptor() const override { return source_->poll_descriptor(); }

  std::unique_ptr<DatagramSource> let_go() { return std::move(source_); }

 private:
  std::unique_ptr<DatagramSource> source_;
  const SourceCounters before_;
};

// Number of datagrams that wait in the source, or that it drops meanwhile.
std::uint64_t lost_with(DatagramSource& source, const SourceCounters& before) {
  constexpr int kMaxReads = 256;  // it may never be empty
  DatagramBatch batch;
  for (int reads = 0; reads < kMaxReads; ++reads) {
    const std::uint64_t had = source.counters().received;
    if (!source.read(batch, Duration::zero()) || source.counters().received == had) {
      break;
    }
  }
  const SourceCounters counted = since(before, source.counters());
  return counted.received + counted.kernel_drops;
}

}  // namespace

void HandedSources::add(const SourceConfig& config, std::unique_ptr<DatagramSource> source) {
  if (!source || !is_live(config)) {
    return;
  }
  if (auto* const continued = dynamic_cast<ContinuedSource*>(source.get())) {
    source = continued->let_go();
  }
  SourceCounters before = source->counters();
  handed_.push_back({config, std::move(source), std::move(before)});
}

std::unique_ptr<DatagramSource> HandedSources::take(const SourceConfig& config) {
  const auto found = std::find_if(handed_.begin(), handed_.end(), [&](const Handed& one) {
    return is_same(one.config, config);
  });
  if (found == handed_.end()) {
    return nullptr;
  }
  auto source =
      std::make_unique<ContinuedSource>(std::move(found->source), std::move(found->before));
  handed_.erase(found);
  return source;
}

std::uint64_t HandedSources::close_others(const std::string& site,
                                          const std::vector<SourceConfig>& configs) {
  std::uint64_t lost = 0;
  std::erase_if(handed_, [&](Handed& one) {
    const bool goes_on = std::any_of(configs.begin(), configs.end(), [&](const SourceConfig& now) {
      return is_same(one.config, now);
    });
    if (one.config.site != site || goes_on) {
      return false;
    }
    lost += lost_with(*one.source, one.before);
    return true;
  });
  return lost;
}

}  // namespace rayloc
