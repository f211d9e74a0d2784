#include "daemon/live/health/loss_watch.h"

#include <utility>

#include "capture/source/source_advice.h"
#include "daemon/live/health/saturation.h"

namespace rayloc {

void LossWatch::compare(const Loss& loss, std::uint64_t count) {
  const std::string site =
      label_ + (loss.source.empty() ? loss.kind : loss.kind + " " + loss.source);
  std::uint64_t& seen = seen_[site];
  if (count <= seen) {
    return;
  }
  LogEvent event{LogLevel::kWarning, loss.what, {{"loss", loss.kind}}};
  if (!loss.source.empty()) {
    event.message = "source " + loss.source + ": " + event.message;
    event.fields.push_back({"source", loss.source});
  }
  event.message = label_ + event.message;
  event.fields.push_back({"total", std::to_string(count)});
  log_->add(site, std::move(event), count - seen);
  seen = count;
}

void LossWatch::check_source(const v1::SourceReport& source) {
  const std::string& name = source.access_point();
  const v1::SourceCounters& counters = source.counters();
  compare({"kernel_drops", "datagrams lost before we read them: see `rayloc doctor`", name},
          counters.kernel_drops());
  compare({"ring_dropped", "datagrams dropped", name}, counters.ring_dropped());
  compare({"frames_dropped", "frames dropped: estimates take longer than frames to come", name},
          counters.frames_dropped());
  compare({"clock_steps", "the clock of this machine was set; tracks are not affected", name},
          counters.clock_steps());
  compare({"failures", "it could not be read any more, and is opened again", name},
          counters.failures());
  compare({"channel_changes", "the access point changed its channel", name},
          counters.channel_changes());
  for (const auto& [reason, count] : counters.rejected()) {
    const std::string_view advice = source_advice(reason);
    compare({"rejected_" + reason,
             "datagrams rejected: " + reason + (advice.empty() ? "" : "; ") + std::string(advice),
             name},
            count);
  }
}

void LossWatch::check_stream(const v1::StreamCounters& stream) {
  compare({"stream_refused",
           "messages of the site's stream refused: they have changed bytes, or raylocd has another "
           "version on another machine of the cluster"},
          stream.refused());
  compare({"stream_lost",
           "messages of the site's stream were removed before we read them: raise [cluster] "
           "retention_s"},
          stream.lost());
  compare({"stream_missing", "batches of a capture node that are neither there nor marked"},
          stream.missing());
  compare({"stream_unknown", "datagrams of access points that site.toml does not have"},
          stream.unknown());
}

void LossWatch::check(const v1::Heartbeat& heartbeat) {
  for (const v1::SourceReport& source : heartbeat.sources()) {
    check_source(source);
  }
  compare({"frames_refused", "frames of transmitters beyond [limits] max_targets refused"},
          heartbeat.estimation().frames_refused());
  compare({"bursts_merged",
           overload_text("bursts gave way to newer ones of their device, so there are fewer "
                         "estimates")},
          heartbeat.estimation().bursts_merged());
  compare({"bursts_dropped",
           overload_text("bursts waited until they were too old, and were left out; transmitters "
                         "of site.toml come first")},
          heartbeat.estimation().bursts_dropped());
  compare({"events_dropped", "events dropped: the publisher did not keep up"},
          heartbeat.estimation().events_dropped());
  compare({"recorder_dropped", "datagrams missing in the recording: the disk did not keep up"},
          heartbeat.recorder().dropped());
  compare({"csi_dropped", "frames of CSI not published: the publisher did not keep up"},
          heartbeat.publisher().csi_dropped());
  compare({"batches_marked",
           "batches did not reach the cluster: the broker is away or too slow; recording goes on"},
          heartbeat.capture().marked());
  check_stream(heartbeat.stream());
  compare({"snapshot_files_failed", "recent datagrams could not be written"},
          heartbeat.ring_snapshots().failed());
}

void LossWatch::check_shared(const v1::Heartbeat& shared, std::uint64_t log_dropped) {
  compare({"slow_episodes", "a subscriber reads too slowly and loses messages"},
          shared.publisher().slow_episodes());
  compare({"handshakes_failed", "connections that speak no ZeroMQ, have a wrong key or none"},
          shared.publisher().handshakes_failed());
  compare({"clients_cut_off",
           "connections cut off: they sent a message without an end, or were too many"},
          shared.publisher().clients_cut_off());
  compare({"snapshots_dropped", "answers to late subscribers that these did not fetch"},
          shared.snapshot_server().dropped());
  compare({"snapshot_requests_malformed", "requests of late subscribers that are none"},
          shared.snapshot_server().malformed());
  compare({"log_dropped", "messages of this log lost: journal or terminal did not take them"},
          log_dropped);
}

}  // namespace rayloc
