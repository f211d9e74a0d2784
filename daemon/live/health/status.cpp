#include "daemon/live/health/status.h"

#include <array>
#include <numbers>
#include <utility>

#include "daemon/live/health/chain_report.h"
#include "daemon/messages/proto_time.h"

namespace rayloc {
namespace {

void add_rejected(const std::map<std::string, std::uint64_t>& rejected,
                  v1::SourceCounters* counters) {
  for (const auto& [reason, count] : rejected) {
    (*counters->mutable_rejected())[reason] += count;
  }
}

v1::SourceCounters source_counters(const SourceReport& report, const MailboxCounters& mailbox) {
  v1::SourceCounters counters;
  counters.set_received(report.source.received);
  add_rejected(report.source.rejected, &counters);
  add_rejected(report.receiver.rejected, &counters);
  counters.set_kernel_drops(report.source.kernel_drops);
  counters.set_processed(report.receiver.in_frames + report.receiver.duplicates +
                         report.receiver.late);
  counters.set_in_flight(report.receiver.in_flight +
                         (report.source.delivered - report.receiver.received));
  counters.set_duplicates(report.receiver.duplicates);
  counters.set_late(report.receiver.late);
  counters.set_bytes(report.source.bytes);
  counters.set_clock_steps(report.source.clock_steps);
  counters.set_failures(report.source.failures);
  counters.set_channel_changes(report.receiver.channel_changes);
  counters.set_frames_complete(report.receiver.frames - report.receiver.partial);
  counters.set_frames_partial(report.receiver.partial);
  counters.set_frames_dropped(mailbox.dropped);
  counters.set_frames_processed(mailbox.taken);
  counters.set_frames_in_flight(mailbox.waiting + (report.receiver.frames - mailbox.put));
  return counters;
}

// Time since the last datagram, by the monotonic clock.
Duration silence(const SourceReport& report) {
  return std::chrono::steady_clock::now() - report.last_arrival;
}

v1::SourceStatus source_status(const SourceReport& report, const StatusSources::Source& source) {
  if (!report.error.empty()) {
    return v1::SOURCE_STATUS_FAILED;
  }
  if (report.ended) {
    return v1::SOURCE_STATUS_ENDED;
  }
  if (report.source.delivered == 0) {
    return v1::SOURCE_STATUS_WAITING;
  }
  return source.live && silence(report) > source.stall_after ? v1::SOURCE_STATUS_STALLED
                                                             : v1::SOURCE_STATUS_RECEIVING;
}

v1::SourceState source_state(const SourceReport& report,
                             const MailboxCounters& mailbox,
                             const StatusSources::Source& source,
                             Timestamp now,
                             Duration clock_ahead) {
  v1::SourceState state;
  state.set_access_point(report.access_point);
  state.set_status(source_status(report, source));
  *state.mutable_time() = to_proto(now);
  state.set_description(report.description);
  if (report.source.delivered > 0) {
    *state.mutable_last_frame() =
        to_proto(report.last_datagram + (source.live ? clock_ahead : Duration::zero()));
    if (source.live) {
      *state.mutable_age() = to_proto(silence(report));
    }
  }
  *state.mutable_counters() = source_counters(report, mailbox);
  state.set_detail(report.error.empty() ? report.receiver.trouble : report.error);
  if (report.receiver.channel) {
    state.set_channel_centre_hz(report.receiver.channel->centre_hz);
    state.set_channel_bandwidth_mhz(
        static_cast<std::uint32_t>(report.receiver.channel->bandwidth_mhz));
  }
  state.set_format(report.frames.format);
  for (const auto& [rx_chain, census] : report.frames.rx_chains) {
    v1::CoreReport* to = state.add_cores();
    to->set_core(static_cast<std::uint32_t>(rx_chain));
    to->set_frames(census.frames);
    to->set_below_strongest_db(census.below_strongest_db);
  }
  for (const auto& [mhz, frames] : report.frames.frames_by_bandwidth_mhz) {
    (*state.mutable_frames_by_bandwidth_mhz())[static_cast<std::uint32_t>(mhz)] = frames;
  }
  return state;
}

constexpr std::array<const char*, kRanks> kRankNames{
    "listed", "listed_acquisition", "unlisted", "unlisted_acquisition"};

void fill_ranks(const std::vector<RankCounts>& ranks, v1::EstimationCounters* counters) {
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    v1::RankCounters* to = counters->add_ranks();
    to->set_rank(kRankNames.at(i));
    to->set_bursts(ranks[i].ended());
    to->set_bursts_explained(ranks[i].taken);
    to->set_bursts_merged(ranks[i].merged);
    to->set_bursts_dropped(ranks[i].dropped);
    to->set_bursts_in_flight(ranks[i].waiting);
  }
}

void fill_estimation(const StatusSources& sources, v1::EstimationCounters* counters) {
  const EstimationCounters estimation = sources.pipeline->estimation_counters();
  counters->set_bursts(estimation.bursts);
  counters->set_bursts_in_flight(estimation.bursts_in_flight);
  counters->set_bursts_merged(estimation.bursts_merged);
  counters->set_bursts_dropped(estimation.bursts_dropped);
  counters->set_fixes(estimation.snapshots - estimation.no_fix);
  counters->set_no_fixes(estimation.no_fix);
  counters->set_filtered(estimation.filtered);
  counters->set_frames_surplus(estimation.surplus);
  counters->set_frames_refused(estimation.refused);
  counters->set_frames_used(estimation.used);
  counters->set_frames_unwanted(estimation.unwanted);
  counters->set_frames_merged(estimation.merged);
  counters->set_frames_dropped(estimation.dropped);
  counters->set_frames_in_flight(estimation.in_flight);
  fill_ranks(estimation.ranks, counters);
  const SiteOutputCounters publishing = sources.output->counters();
  counters->set_coalesced(publishing.coalesced);
  counters->set_events_dropped(publishing.events_dropped);
}

// Published messages contain the publisher's own, newer numbers; these are for HTTP.
void fill_publisher(const PublishedCounters& published, v1::PublisherCounters* counters) {
  counters->set_published(published.published);
  counters->set_slow_episodes(published.slow_episodes);
  counters->set_subscriptions(published.subscriptions);
  counters->set_clients_denied(published.clients_denied);
  counters->set_handshakes_failed(published.handshakes_failed);
  counters->set_clients_cut_off(published.clients_cut_off);
}

void fill_tracker(const DeviceEstimator& estimator, v1::TrackerCounters* counters) {
  const TrackerCounters tracker = estimator.tracker_counters();
  counters->set_tracks(tracker.begun - tracker.lost);
  counters->set_begun(tracker.begun);
  counters->set_lost(tracker.lost);
  counters->set_moments(tracker.moments);
  counters->set_used(tracker.used);
  counters->set_out_of_order(tracker.out_of_order);
  counters->set_unusable(tracker.unusable);
  counters->set_unexplained(tracker.unexplained);
  counters->set_bursts_refused(tracker.refused);
}

void fill_person_tracker(const PersonEstimator& estimator, v1::PersonTrackerCounters* counters) {
  const PersonTrackerCounters tracker = estimator.tracker_counters();
  counters->set_tracks(tracker.begun - tracker.lost);
  counters->set_begun(tracker.begun);
  counters->set_lost(tracker.lost);
  counters->set_moments(tracker.moments);
  counters->set_used(tracker.used);
  counters->set_nobody(tracker.no_person);
  counters->set_unexplained(tracker.unexplained);
  counters->set_out_of_order(tracker.out_of_order);
  counters->set_unusable(tracker.unusable);
  counters->set_frames_passed_over(tracker.passed_over);
}

void fill_compared(const ComparedMethod& method, v1::ComparedCounters* counters) {
  const ComparedMethodCounters now = method.counters();
  counters->set_method(method.name());
  counters->set_bursts(now.bursts);
  counters->set_bursts_explained(now.explained);
  counters->set_bursts_dropped(now.dropped);
  counters->set_bursts_in_flight(now.in_flight);
  counters->set_fixes(now.fixes);
  counters->set_no_fixes(now.no_fixes);
  counters->set_filtered(now.filtered);
  counters->set_coalesced(now.coalesced);
}

void fill_ring_snapshots(const RingSnapshotCounters& now, v1::RingSnapshotCounters* counters) {
  counters->set_written(now.files);
  counters->set_failed(now.failed);
}

void fill_recorder(const StatusSources& sources, v1::RecorderCounters* counters) {
  for (const RecorderStage* recorder : sources.recorders) {
    const RecorderStageCounters recorded = recorder->counters();
    counters->set_given(counters->given() + recorded.tapped);
    counters->set_written(counters->written() + recorded.written);
    counters->set_dropped(counters->dropped() + recorded.dropped);
    counters->set_in_flight(counters->in_flight() + recorded.waiting);
    counters->set_bytes(counters->bytes() + recorded.files.bytes);
    counters->set_files(counters->files() + recorded.files.files);
    counters->set_files_removed(counters->files_removed() + recorded.files.removed);
    counters->set_gaps(counters->gaps() + recorded.files.gaps);
    counters->set_no_room(counters->no_room() + recorded.files.stops);
    counters->set_stopped(counters->stopped() + (recorded.files.stopped ? 1U : 0U));
  }
  counters->set_repaired(sources.recordings_repaired);
}

void fill_http(const HttpCounters& http, v1::HttpCounters* counters) {
  for (const auto& [status, count] : http.requests) {
    (*counters->mutable_requests())[static_cast<std::uint32_t>(status)] = count;
  }
  counters->set_closed_slow(http.timed_out);
  counters->set_closed_displaced(http.displaced);
  counters->set_viewers(http.viewers);
  counters->set_viewers_left(http.viewers_left);
  counters->set_viewers_stuck(http.viewers_stuck);
  counters->set_viewers_refused(http.viewers_refused);
  counters->set_events(http.events);
  counters->set_messages_coalesced(http.messages_coalesced);
}

void fill_shared(const StatusSources& sources, v1::Heartbeat& heartbeat) {
  if (sources.snapshots != nullptr) {
    const SnapshotCounters snapshots = sources.snapshots->counters();
    heartbeat.mutable_snapshot_server()->set_answered(snapshots.answered);
    heartbeat.mutable_snapshot_server()->set_malformed(snapshots.malformed);
    heartbeat.mutable_snapshot_server()->set_dropped(snapshots.dropped);
  }
  if (sources.http != nullptr) {
    fill_http(sources.http->counters(), heartbeat.mutable_http());
  }
}

v1::Georeference georeference_proto(const Georeference& georeference) {
  v1::Georeference message;
  message.set_latitude_deg(georeference.latitude);
  message.set_longitude_deg(georeference.longitude);
  message.set_altitude_m(georeference.altitude);
  message.set_rotation_deg(georeference.rotation * 180.0 / std::numbers::pi);
  return message;
}

// Fills in the identity of the daemon and the site.
void fill_who(const StatusSources& sources, Timestamp now, v1::Heartbeat& heartbeat) {
  *heartbeat.mutable_time() = to_proto(now);
  *heartbeat.mutable_started() = to_proto(sources.started);
  heartbeat.set_epoch(sources.epoch);
  heartbeat.set_message_version("v1");
  heartbeat.set_software_version(RAYLOC_VERSION);
  heartbeat.set_scene_hash(sources.scene_hash);
  heartbeat.set_calibration_id(sources.calibration_id);
  if (sources.georeference) {
    *heartbeat.mutable_georeference() = georeference_proto(*sources.georeference);
  }
  if (sources.reloads) {
    *heartbeat.mutable_reloads() = *sources.reloads;
  }
}

}  // namespace

v1::Playback playback_message(const Playback::State& state) {
  v1::Playback message;
  switch (state.running) {
    case Playback::Running::kPlaying:
      message.set_state(v1::PLAYBACK_STATE_PLAYING);
      break;
    case Playback::Running::kPaused:
      message.set_state(v1::PLAYBACK_STATE_PAUSED);
      break;
    case Playback::Running::kEnded:
      message.set_state(v1::PLAYBACK_STATE_ENDED);
      break;
  }
  *message.mutable_begin() = to_proto(state.begin);
  *message.mutable_end() = to_proto(state.end);
  *message.mutable_position() = to_proto(state.position);
  if (state.speed) {
    message.set_speed(*state.speed);
  }
  message.set_moves(state.moves);
  for (const TimeSpan& gap : state.skipped) {
    v1::PlaybackGap& skipped = *message.add_skipped();
    *skipped.mutable_begin() = to_proto(gap.begin);
    *skipped.mutable_end() = to_proto(gap.end);
  }
  return message;
}

StatusMessages status_messages(const StatusSources& sources, Timestamp now) {
  StatusMessages messages;
  v1::Heartbeat& heartbeat = messages.heartbeat;
  fill_who(sources, now, heartbeat);
  if (sources.warnings) {
    for (std::string& warning : sources.warnings()) {
      heartbeat.add_warnings(std::move(warning));
    }
  }
  if (sources.estimator != nullptr) {
    for (const CalibrationWarning& warning : sources.estimator->calibration_warnings()) {
      heartbeat.add_calibration_warnings(warning.text);
    }
    fill_tracker(*sources.estimator, heartbeat.mutable_tracker());
    for (const ChainState& state : sources.estimator->chain_states()) {
      *heartbeat.add_chains() = chain_report(state, sources.estimator->room());
    }
  }
  if (sources.people != nullptr) {
    fill_person_tracker(*sources.people, heartbeat.mutable_person_tracker());
  }
  for (const ComparedMethod* method : sources.compared) {
    fill_compared(*method, heartbeat.add_compared());
  }
  // The mailbox first: a receiving thread reports its frames before it puts them there, so that its
  // later report contains all frames of the mailbox.
  const std::vector<MailboxCounters> mailbox = sources.pipeline->mailbox_counters();
  const std::vector<SourceReport> reports = sources.pipeline->source_reports();
  const Duration clock_ahead = sources.clock ? sources.clock->now() : Duration::zero();
  for (std::size_t i = 0; i < reports.size(); ++i) {
    messages.sources.push_back(
        source_state(reports[i], mailbox[i], sources.sources[i], now, clock_ahead));
    const v1::SourceState& state = messages.sources.back();
    v1::SourceReport* report = heartbeat.add_sources();
    report->set_access_point(state.access_point());
    report->set_status(state.status());
    if (state.has_age()) {
      *report->mutable_age() = state.age();
    }
    *report->mutable_counters() = state.counters();
    if (!reports[i].receiver.trouble.empty()) {
      heartbeat.add_warnings("source " + state.access_point() + ": " + state.detail());
    }
  }
  if (sources.playback) {
    *heartbeat.mutable_playback() = playback_message(sources.playback->state());
  }
  fill_estimation(sources, heartbeat.mutable_estimation());
  const SiteOutputCounters output = sources.output->counters();
  fill_publisher(output.published, heartbeat.mutable_publisher());
  heartbeat.mutable_publisher()->set_csi_dropped(output.csi_dropped);
  if (!sources.recorders.empty()) {
    fill_recorder(sources, heartbeat.mutable_recorder());
  }
  if (sources.ring_snapshots != nullptr) {
    fill_ring_snapshots(sources.ring_snapshots->counters(), heartbeat.mutable_ring_snapshots());
  }
  fill_shared(sources, heartbeat);
  return messages;
}

v1::Heartbeat shared_counters(const PublishedCounters& published, const StatusSources& sources) {
  v1::Heartbeat heartbeat;
  fill_publisher(published, heartbeat.mutable_publisher());
  fill_shared(sources, heartbeat);
  return heartbeat;
}

}  // namespace rayloc
