#include "daemon/service/status.h"

#include "daemon/publish/proto_time.h"

namespace rayloc {
namespace {

// A source that has been silent for longer is reported as stalled.
constexpr Duration kStalledAfter = std::chrono::seconds(5);

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
  counters.set_frames_complete(report.receiver.frames - report.receiver.partial);
  counters.set_frames_partial(report.receiver.partial);
  counters.set_frames_dropped(mailbox.dropped);
  counters.set_frames_processed(mailbox.taken);
  counters.set_frames_in_flight(mailbox.waiting + (report.receiver.frames - mailbox.put));
  return counters;
}

v1::SourceStatus source_status(const SourceReport& report, bool live, Timestamp now) {
  if (!report.error.empty()) {
    return v1::SOURCE_STATUS_FAILED;
  }
  if (report.ended) {
    return v1::SOURCE_STATUS_ENDED;
  }
  if (report.source.delivered == 0) {
    return v1::SOURCE_STATUS_WAITING;
  }
  return live && now - report.last_datagram > kStalledAfter ? v1::SOURCE_STATUS_STALLED
                                                            : v1::SOURCE_STATUS_RECEIVING;
}

v1::SourceState source_state(const SourceReport& report,
                             const MailboxCounters& mailbox,
                             bool live,
                             Timestamp now) {
  v1::SourceState state;
  state.set_access_point(report.access_point);
  state.set_status(source_status(report, live, now));
  *state.mutable_time() = to_proto(now);
  state.set_description(report.description);
  if (report.source.delivered > 0) {
    *state.mutable_last_frame() = to_proto(report.last_datagram);
    if (live) {
      *state.mutable_age() = to_proto(now - report.last_datagram);
    }
  }
  *state.mutable_counters() = source_counters(report, mailbox);
  state.set_detail(report.error);
  return state;
}

void fill_estimation(const StatusSources& sources, v1::EstimationCounters* counters) {
  const EstimationCounters estimation = sources.pipeline->estimation_counters();
  counters->set_bursts(estimation.bursts);
  counters->set_bursts_in_flight(estimation.bursts_in_flight);
  counters->set_fixes(estimation.locations - estimation.no_fix);
  counters->set_no_fixes(estimation.no_fix);
  counters->set_frames_surplus(estimation.surplus);
  counters->set_frames_refused(estimation.refused);
  counters->set_frames_used(estimation.used);
  counters->set_frames_unwanted(estimation.unwanted);
  counters->set_frames_in_flight(estimation.in_flight);
  counters->set_coalesced(sources.publisher->counters().coalesced);
}

void fill_recorder(const StatusSources& sources, v1::RecorderCounters* counters) {
  for (const RecorderStage* recorder : sources.recorders) {
    const RecorderStageCounters recorded = recorder->counters();
    counters->set_given(counters->given() + recorded.tapped);
    counters->set_written(counters->written() + recorded.written);
    counters->set_dropped(counters->dropped() + recorded.dropped);
    counters->set_in_flight(counters->in_flight() + recorded.waiting);
  }
}

}  // namespace

StatusMessages status_messages(const StatusSources& sources, Timestamp now) {
  StatusMessages messages;
  v1::Heartbeat& heartbeat = messages.heartbeat;
  *heartbeat.mutable_time() = to_proto(now);
  *heartbeat.mutable_started() = to_proto(sources.started);
  heartbeat.set_software_version(RAYLOC_VERSION);
  heartbeat.set_scene_hash(sources.scene_hash);
  heartbeat.set_calibration_id(sources.calibration_id);
  for (const CalibrationWarning& warning : sources.estimator->calibration_warnings()) {
    heartbeat.add_calibration_warnings(warning.text);
  }
  // The mailbox first: a receiving thread reports its frames before it puts them there, so that
  // what it reports afterwards contains whatever the mailbox had.
  const std::vector<MailboxCounters> mailbox = sources.pipeline->mailbox_counters();
  const std::vector<SourceReport> reports = sources.pipeline->source_reports();
  for (std::size_t i = 0; i < reports.size(); ++i) {
    messages.sources.push_back(source_state(reports[i], mailbox[i], sources.live[i], now));
    const v1::SourceState& state = messages.sources.back();
    v1::SourceReport* report = heartbeat.add_sources();
    report->set_access_point(state.access_point());
    report->set_status(state.status());
    if (state.has_age()) {
      *report->mutable_age() = state.age();
    }
    *report->mutable_counters() = state.counters();
  }
  fill_estimation(sources, heartbeat.mutable_estimation());
  if (!sources.recorders.empty()) {
    fill_recorder(sources, heartbeat.mutable_recorder());
  }
  return messages;
}

}  // namespace rayloc
