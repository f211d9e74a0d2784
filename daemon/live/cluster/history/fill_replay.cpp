#include "daemon/live/cluster/history/fill_replay.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "daemon/live/cluster/batch.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/ownership/out_items.h"

namespace rayloc {
namespace {

using Parts = std::map<std::string, std::vector<BatchPart>>;  // by access point

// All data of one access point.
class FilledSource final : public DatagramSource {
 public:
  explicit FilledSource(std::vector<BatchPart> parts)
      : parts_(std::make_move_iterator(parts.begin()), std::make_move_iterator(parts.end())) {}

  Expected<void> read(DatagramBatch& batch, Duration /*timeout*/) override {
    batch = {};
    batch.ended = parts_.empty();
    if (!parts_.empty()) {
      current_ = std::move(parts_.front());
      parts_.pop_front();
      batch.datagrams = current_.datagrams.datagrams();
      batch.watermark = current_.watermark;
      counters_.received += batch.datagrams.size();
      counters_.delivered += batch.datagrams.size();
      counters_.bytes += current_.datagrams.payloads.size();
    }
    return {};
  }
  SourceCounters counters() const override { return counters_; }
  std::string description() const override { return "cluster stream " + std::string(kFillStream); }

 private:
  std::deque<BatchPart> parts_;
  BatchPart current_;
  SourceCounters counters_;
};

class FilledSink final : public LocationSink {
 public:
  explicit FilledSink(const StreamReplay& replay) : replay_(replay) {}
  void location(Location&& location) override { items_.add(std::move(location)); }
  void event(TrackEvent&& event) override { items_.add(std::move(event)); }
  void event(ZoneEvent&& event) override { items_.add(std::move(event)); }
  void advance(Timestamp time) override {
    if (items_.advance(time)) {
      const OutItems::Part part = items_.take(std::numeric_limits<std::size_t>::max());
      for (const v1::OutputItem& item : part.output.items()) {
        ++results_;
        replay_.on_result(item);
      }
    }
  }
  std::size_t results() const { return results_; }

 private:
  const StreamReplay& replay_;
  OutItems items_{Timestamp::min()};
  std::size_t results_ = 0;
};

// Reads each batch once, even if stored twice; ordered by time, as starts of a node have no order.
Expected<Parts> read_parts(Broker& broker, const StreamReplay& replay, FillReport& report) {
  const std::string stream(kFillStream);
  const Expected<StreamState> state = broker.stream_state(stream);
  RAYLOC_TRY(state);
  const std::string subjects = fill_prefix(replay.site);
  std::set<std::tuple<std::string, std::uint64_t, std::uint64_t>> known;
  Parts parts;
  for (std::uint64_t sequence = state->first; sequence <= state->last; ++sequence) {
    auto message = broker.get(stream, sequence);
    RAYLOC_TRY(message);
    if (!*message || (*message)->subject.rfind(subjects, 0) != 0) {
      continue;
    }
    auto batch = decode_batch((*message)->data);
    if (!batch || !known.emplace((*message)->subject, batch->epoch, batch->number).second) {
      continue;
    }
    ++report.batches;
    for (BatchPart& part : batch->parts) {
      parts[part.access_point].push_back(std::move(part));
    }
  }
  for (auto& [access_point, all] : parts) {
    std::stable_sort(all.begin(), all.end(), [](const BatchPart& a, const BatchPart& b) {
      return a.watermark < b.watermark;
    });
  }
  return parts;
}

}  // namespace

Expected<FillReport> replay_fill(Broker& broker, const StreamReplay& replay) {
  FillReport report;
  auto parts = read_parts(broker, replay, report);
  RAYLOC_TRY(parts);
  std::vector<std::unique_ptr<DatagramSource>> sources;
  sources.reserve(replay.access_points.size());
  for (const std::string& access_point : replay.access_points) {
    std::vector<BatchPart>& some = (*parts)[access_point];
    for (const BatchPart& part : some) {
      report.datagrams += part.datagrams.entries.size();
    }
    sources.push_back(std::make_unique<FilledSource>(std::move(some)));
  }
  FilledSink sink(replay);
  RAYLOC_TRY(replay.run({}, std::move(sources), sink));
  sink.advance(Timestamp::max());
  report.items = sink.results();
  return report;
}

}  // namespace rayloc
