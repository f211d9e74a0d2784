// The part of SiteRuntime that makes it the site of a capture node or of a worker.
#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/live/service/cluster_options.h"
#include "daemon/live/service/site/site_runtime.h"

namespace rayloc {
namespace {

// Between the states that a successor may continue from.
constexpr std::chrono::seconds kCarryEvery{1};

}  // namespace

Expected<void> SiteRuntime::claim(std::uint64_t generation) {
  owner_records_.reset();  // from here on the output is its own
  OwnerLog::Options options;
  options.site = setup_.site.name;
  options.generation = generation;
  options.worker = setup_.config.cluster.name;
  options.build = RAYLOC_VERSION;
  options.stream = output_stream(result_options(setup_.config.cluster));
  if (along_) {
    options.along = along_->start;
  }
  auto log = OwnerLog::begin(surroundings_.broker, std::move(options));
  RAYLOC_TRY(log);
  log_ = std::move(*log);
  if (along_) {
    if (log_->start().from < results_->gone_before()) {
      return make_error(
          ErrorKind::kUnavailable,
          "the stream of results has lost records of the owner that this worker received");
    }
    start_.generation = generation;
    return {};
  }
  start_ = log_->start();
  return start_.carried ? restore_estimators(start_.carried) : Expected<void>();
}

Expected<void> SiteRuntime::begin_standby(StandbyStart along) {
  along_ = std::move(along);
  start_ = along_->start;
  start_.generation = 0;  // it owns no site
  return start_.carried ? restore_estimators(start_.carried) : Expected<void>();
}

// REQUIRES: claim().
void SiteRuntime::take_over() {
  later_frames_->set_from(log_->start().from);
  results_->promote(std::move(log_));
  feed_->take_over();
}

std::optional<OutStage::Standby> SiteRuntime::standby() const {
  std::optional<OutStage::Standby> standby = results_ ? results_->standby() : std::nullopt;
  if (standby && standby->trouble.empty()) {
    const SiteFeed::Counters received = feed_->counters();
    if (received.stream.lost > 0 || received.stream.streams > 0) {
      standby->trouble = "the site's stream has lost what it had not read yet";
    }
  }
  return standby;
}

// The room was prepared before the start of the processing was determined.
Expected<void> SiteRuntime::restore_estimators(const std::shared_ptr<const Carried>& before) {
  Expected<void> restored = estimators_->go_on(before);
  status_.people = estimators_->people();
  return restored;
}

// Opens its part of a cluster, if it has one.
Expected<void> SiteRuntime::open_cluster(SiteOutput& output) {
  if (surroundings_.capture != nullptr) {
    auto sender = surroundings_.capture->add_site(setup_.site.name);
    RAYLOC_TRY(sender);
    sender_ = std::move(*sender);
  }
  return log_ || along_ ? open_feed(output) : Expected<void>();
}

Expected<void> SiteRuntime::open_feed(SiteOutput& output) {
  const std::string& site = setup_.site.name;
  SiteFeed::Options options;
  options.site = site;
  options.stream = site_stream(site, stream_options(setup_.config.cluster));
  options.resume = start_.resume;
  options.only_listens = along_.has_value();
  // Processing ends where the earliest open burst begins.
  options.shed.most_lag += setup_.config.engine.burst;
  options.shed.least_lag += setup_.config.engine.burst;
  for (const SourceConfig& source : setup_.config.sources) {
    options.access_points.push_back(source.access_point);
  }
  auto feed = SiteFeed::open(surroundings_.broker, std::move(options));
  RAYLOC_TRY(feed);
  feed_ = std::move(*feed);
  later_frames_ = std::make_unique<LaterFrames>(output, along_ ? Timestamp::max() : start_.from);
  OutStage::Options results;
  results.warm_up = setup_.config.cluster.rewarm;
  results.resume = [feed = feed_.get()](Timestamp time) { return feed->resume_for(time); };
  results.progress = [feed = feed_.get()](Timestamp done) { feed->note_done(done); };
  if (along_) {
    return subscribe_to_owner(output, std::move(results));
  }
  results_ = std::make_unique<OutStage>(std::move(log_), output, std::move(results));
  return {};
}

Expected<void> SiteRuntime::subscribe_to_owner(SiteOutput& output, OutStage::Options options) {
  StandbyAudit::Options audit;
  audit.generation = along_->start.generation;
  audit.likeness = along_->is_late ? Likeness::kSameSnapshots : Likeness::kSameBytes;
  results_ = std::make_unique<OutStage>(start_, output, std::move(options), audit);
  auto words = surroundings_.broker->subscribe(output_again_subject(setup_.site.name),
                                               [results = results_.get()](BrokerMessage&& message) {
                                                 v1::OutputRecord record;
                                                 if (unseal(message.data, record)) {
                                                   results->receive(std::move(record));
                                                 }
                                               });
  RAYLOC_TRY(words);
  owner_records_ = std::move(*words);
  return {};
}

// REQUIRES: it has results.
LocationSink& SiteRuntime::go_on(PipelineOptions& options) {
  options.carry_every = kCarryEvery;
  options.promises_are_kept = true;
  options.from = start_.from;
  if (start_.carried) {
    options.open = start_.carried->open;
  }
  return *results_;
}

void SiteRuntime::give_back() {
  if (results_) {
    results_->finish();
    pipeline_->cancel_pending();  // its results would have no subscriber
  }
}

std::string SiteRuntime::lost() const { return results_ ? results_->ended() : ""; }

}  // namespace rayloc
