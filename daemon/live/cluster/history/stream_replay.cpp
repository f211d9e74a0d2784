#include "daemon/live/cluster/history/stream_replay.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/history/story.h"
#include "daemon/live/cluster/ownership/compared_item.h"
#include "daemon/live/cluster/ownership/out_items.h"
#include "daemon/live/cluster/site_feed.h"

namespace rayloc {
namespace {

Likeness likeness(const StreamReplay& replay) {
  return replay.uninterrupted ? Likeness::kSameSnapshots : Likeness::kSameBytes;
}

// Publishes the recomputed results of an owner, and compares.
class ChapterSink final : public LocationSink {
 public:
  ChapterSink(const Chapter& chapter, const StreamReplay& replay, SiteFeed& feed)
      : chapter_(chapter), replay_(replay), feed_(feed), items_(chapter.start.from) {
    items_.begin_at(chapter.from);
    for (const v1::OutputItem& item : chapter.items) {
      if (std::string text = compared(item, likeness(replay)); !text.empty()) {
        published_.push_back(std::move(text));
      }
    }
  }

  void location(Location&& location) override { items_.add(std::move(location)); }
  void event(TrackEvent&& event) override { items_.add(std::move(event)); }
  void event(ZoneEvent&& event) override { items_.add(std::move(event)); }
  void advance(Timestamp time) override {
    if (items_.advance(std::min(time, chapter_.done))) {
      publish_ready();
    }
    if (time >= chapter_.done) {
      feed_.end();
    }
  }
  void finish(StreamReplayReport& report) {
    advance(Timestamp::max());
    differing_ += published_.size() - std::min(published_.size(), compared_);
    report.items += results_;
    report.differing += differing_;
    if (differing_ > 0) {
      report.notes.push_back(fmt::format(
          "generation {}: {} results of {} are others than the {} that '{}' published{}",
          chapter_.start.generation,
          differing_,
          results_,
          chapter_.items.size(),
          chapter_.begin.worker(),
          first_.empty() ? "" : ", first " + first_));
    }
  }

 private:
  void publish_ready() {
    const OutItems::Part part = items_.take(std::numeric_limits<std::size_t>::max());
    for (const v1::OutputItem& item : part.output.items()) {
      if (const std::string text = compared(item, likeness(replay_)); !text.empty()) {
        if (compared_ >= published_.size() || text != published_[compared_]) {
          first_ = differing_ == 0 ? item.ShortDebugString() : first_;
          ++differing_;
        }
        ++compared_;
      }
      ++results_;
      replay_.on_result(item);
    }
  }

  const Chapter& chapter_;
  const StreamReplay& replay_;
  SiteFeed& feed_;
  OutItems items_;
  std::vector<std::string> published_;
  std::size_t compared_ = 0;  // compared results
  std::size_t results_ = 0;
  std::size_t differing_ = 0;
  std::string first_;
};

// Reason why its owner cannot be replayed; empty: it can.
std::string obstacle(const Chapter& chapter, const StreamState& stream) {
  const StreamReader::Place& place = chapter.start.resume.place;
  if (place.created != Timestamp{} && place.created != stream.created) {
    return "the stream that it read is gone";
  }
  if (place.sequence + 1 < stream.first) {
    return fmt::format("the stream has forgotten {} messages that it read",
                       stream.first - 1 - place.sequence);
  }
  return "";
}

// REQUIRES: not empty.
Chapter in_one(std::vector<Chapter> story) {
  Chapter all = std::move(story.front());
  for (std::size_t i = 1; i < story.size(); ++i) {
    all.done = story[i].done;
    all.items.insert(all.items.end(), story[i].items.begin(), story[i].items.end());
  }
  return all;
}

Expected<void> replay_chapter(const std::shared_ptr<Broker>& broker,
                              const StreamReplay& replay,
                              const Chapter& chapter,
                              std::uint64_t until,
                              StreamReplayReport& report) {
  SiteFeed::Options options;
  options.site = replay.site;
  options.access_points = replay.access_points;
  options.resume = chapter.start.resume;
  options.until = until;
  auto feed = SiteFeed::open(broker, std::move(options));
  RAYLOC_TRY(feed);
  std::vector<std::unique_ptr<DatagramSource>> sources;
  sources.reserve(replay.access_points.size());
  for (std::size_t i = 0; i < replay.access_points.size(); ++i) {
    sources.push_back((*feed)->source(i));
  }
  ChapterSink sink(chapter, replay, **feed);
  (*feed)->start();
  RAYLOC_TRY(replay.run(chapter.start, std::move(sources), sink));
  (*feed)->finish();
  sink.finish(report);
  ++report.owners;
  return {};
}

}  // namespace

Expected<StreamReplayReport> replay_stream(const std::shared_ptr<Broker>& broker,
                                           const StreamReplay& replay) {
  auto story = read_story(*broker, replay.site);
  RAYLOC_TRY(story);
  auto chapters = *std::move(story);
  if (replay.uninterrupted && !chapters.empty()) {
    Chapter whole = in_one(std::move(chapters));
    chapters = {std::move(whole)};
  }
  const Expected<StreamState> stream = broker->stream_state(csi_stream(replay.site));
  RAYLOC_TRY(stream);
  StreamReplayReport report;
  for (const Chapter& chapter : chapters) {
    if (const std::string why = obstacle(chapter, *stream); !why.empty()) {
      report.notes.push_back(fmt::format("generation {}, of worker '{}', is left out: {}",
                                         chapter.start.generation,
                                         chapter.begin.worker(),
                                         why));
      continue;
    }
    RAYLOC_TRY(replay_chapter(broker, replay, chapter, stream->last, report));
  }
  if (report.owners == 0) {
    return make_error(ErrorKind::kUnavailable,
                      "site '" + replay.site + "': " +
                          (report.notes.empty() ? "the stream of results holds no owner of it"
                                                : report.notes.back()));
  }
  return report;
}

}  // namespace rayloc
