#include "daemon/live/service/sources/source_factory.h"

#include <fcntl.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "capture/source/recorded_source.h"
#include "capture/source/reopening_source.h"
#include "capture/source/transport_schemes.h"
#include "capture/transport/file_descriptor.h"
#include "daemon/live/config/recording_files.h"
#include "daemon/live/log/log.h"
#include "daemon/pipeline/method_receiver.h"
#include "daemon/pipeline/playback/playback_source.h"

namespace rayloc {
namespace {

// Opens the files anew at each call, at the beginning.
Expected<std::unique_ptr<DatagramSource>> open_planned(const RecordingPlan& plan) {
  return as_transport<DatagramSource>(RecordedSource::open(plan));
}

Expected<std::unique_ptr<DatagramSource>> open_recording(const SourceConfig& source,
                                                         const RecordingClock& clock) {
  const RecordingPlan& plan = clock.plans.at(source.access_point);
  if (clock.playback) {
    return as_transport<DatagramSource>(
        PlaybackSource::open([plan] { return open_planned(plan); }, clock.playback));
  }
  auto recording = open_planned(plan);
  if (!recording || !clock.pace) {
    return recording;
  }
  return std::unique_ptr<DatagramSource>(
      std::make_unique<PacedSource>(std::move(*recording), clock.pace));
}

Expected<RecordingPlan> plan_of(const SourceConfig& source) {
  PcapFileOptions options;
  options.max_gap = source.max_gap;
  return plan_recording(recording_files(source), options);
}

Error placed(const SourceConfig& source, Error error) {
  error.message = source.place + error.message;
  return error;
}

// Logs the risk of losses in the buffer, and earlier losses.
void log_buffer(const ReceiveBuffer& buffer, const std::string& name) {
  const std::vector<LogField> fields = {{"source", name}};
  if (buffer.granted_bytes < buffer.wanted_bytes) {
    const std::string wanted = std::to_string(buffer.wanted_bytes);
    log_event({LogLevel::kWarning,
               "source " + name + ": the kernel grants a receive buffer of " +
                   std::to_string(buffer.granted_bytes) + " bytes instead of " + wanted +
                   ", and bursts of datagrams may be lost; sysctl -w net.core.rmem_max=" + wanted +
                   ", then restart",
               fields});
  }
  if (buffer.dropped_before > 0) {
    log_event({LogLevel::kInfo,
               "source " + name + ": its socket lost " + std::to_string(buffer.dropped_before) +
                   " datagrams before it was taken over; they are not counted here",
               fields});
  }
}

// `passed_socket`: to be taken over; -1 for none.
Expected<std::unique_ptr<DatagramSource>> open_transport(const SourceConfig& source,
                                                         int passed_socket) {
  auto options = source_options(source);
  RAYLOC_TRY(options);
  options->adopted_fd = passed_socket;
  return open_datagram_source(transport_schemes(), source_url(source), {}, *options);
}

Expected<std::unique_ptr<DatagramSource>> open_live(const SourceConfig& source, int passed_socket) {
  auto opened = open_transport(source, passed_socket);
  if (opened) {
    log_buffer((*opened)->receive_buffer(), source.access_point);
  }
  return opened;
}

Expected<std::unique_ptr<DatagramSource>> open_datagrams(const SourceConfig& source,
                                                         std::optional<int> passed_socket,
                                                         const RecordingClock& clock) {
  if (!is_live(source)) {
    return open_recording(source, clock);
  }
  if (!passed_socket) {
    return as_transport<DatagramSource>(
        ReopeningSource::open([source] { return open_live(source, -1); }));
  }
  // systemd passes a socket once: the source gets a copy to close.
  const auto passed = std::make_shared<const FileDescriptor>(*passed_socket);
  return as_transport<DatagramSource>(
      ReopeningSource::open([source, passed]() -> Expected<std::unique_ptr<DatagramSource>> {
        const int copy = fcntl(passed->get(), F_DUPFD_CLOEXEC, 0);
        if (copy < 0) {
          return make_error(ErrorKind::kUnavailable,
                            std::string("the socket of systemd: ") + std::strerror(errno));
        }
        return open_live(source, copy);
      }));
}

}  // namespace

Expected<RecordingClock> recording_clock(const DaemonConfig& config) {
  RecordingClock clock;
  std::optional<double> speed;
  Duration max_gap = kMaxGap;
  bool all_files = true;
  for (const SourceConfig& source : config.sources) {
    if (source.kind != SourceKind::kPcap) {
      all_files = false;
      continue;
    }
    speed = source.speed;  // the same for all, as the configuration requires
    max_gap = source.max_gap;
    auto plan = plan_of(source);
    if (!plan) {
      return tl::make_unexpected(placed(source, plan.error()));
    }
    for (const std::string& words : describe(*plan)) {
      log_event({LogLevel::kWarning,
                 "source " + source.access_point + ": " + words,
                 {{"source", source.access_point}}});
    }
    for (const PlannedFile& file : plan->files) {
      all_files = all_files && file.scan;
    }
    clock.plans.emplace(source.access_point, *std::move(plan));
  }
  std::vector<RecordingPlan> plans;
  for (const auto& [access_point, plan] : clock.plans) {
    plans.push_back(plan);
  }
  Playback::Options options;
  options.busy = busy_times(plans);
  if (!all_files || options.busy.empty()) {
    clock.pace = speed ? std::make_shared<Pace>(*speed, max_gap) : nullptr;
    return clock;
  }
  options.speed = speed;
  options.max_gap = max_gap;
  // Two bursts before a position: then all targets are located.
  options.lead_in = 2 * config.engine.burst + std::chrono::milliseconds(300);
  clock.playback = std::make_shared<Playback>(std::move(options));
  return clock;
}

Expected<void> check_source(const SourceConfig& source) {
  const auto opened = is_live(source) ? open_transport(source, -1) : nullptr;
  return opened ? Expected<void>() : tl::make_unexpected(placed(source, opened.error()));
}

SourceWorker::Input source_input(const SourceConfig& config,
                                 const Site& site,
                                 const Method* method,
                                 std::unique_ptr<DatagramSource> source) {
  const std::size_t index = config.access_point_index.value();
  SourceWorker::Input input;
  input.access_point = site.access_points[index].id;
  input.source = std::move(source);
  input.receiver = receiver_options(site, index, method);
  if (!config.format.empty()) {
    input.receiver.format = config.format;
  }
  return input;
}

Expected<SourceWorker::Input> open_source(const SourceConfig& source,
                                          const Site& site,
                                          const Method* method,
                                          std::optional<int> passed_socket,
                                          const RecordingClock& clock) {
  Expected<std::unique_ptr<DatagramSource>> opened = open_datagrams(source, passed_socket, clock);
  if (!opened) {
    return tl::make_unexpected(placed(source, opened.error()));
  }
  return source_input(source, site, method, std::move(*opened));
}

}  // namespace rayloc
