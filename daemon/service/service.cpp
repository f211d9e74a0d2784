#include "daemon/service/service.h"

#include <algorithm>
#include <future>
#include <system_error>
#include <utility>

#include <fmt/chrono.h>

#include "capture/pcap_recorder.h"
#include "daemon/service/source_factory.h"

namespace rayloc {
namespace {

constexpr auto kRepeatWarning = std::chrono::minutes(10);

Timestamp system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

// "ap1-20261121T140509Z.pcap": one file per access point and start.
std::filesystem::path recording_path(const std::filesystem::path& directory,
                                     const std::string& access_point,
                                     Timestamp started) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(
      std::chrono::time_point_cast<std::chrono::system_clock::duration>(started));
  return directory / fmt::format("{}-{:%Y%m%dT%H%M%SZ}.pcap", access_point, fmt::gmtime(seconds));
}

Expected<std::unique_ptr<RecorderStage>> open_recorder(const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::create_directories(path.parent_path(), failed);
  if (failed) {
    return make_error(ErrorKind::kUnavailable,
                      path.parent_path().string() + ": cannot be made: " + failed.message());
  }
  Expected<PcapRecorder> recorder = PcapRecorder::create(path);
  if (!recorder) {
    return tl::make_unexpected(recorder.error());
  }
  return std::make_unique<RecorderStage>(std::move(*recorder));
}

}  // namespace

Expected<std::unique_ptr<Service>> Service::open(DaemonSetup setup) {
  std::unique_ptr<Service> service(new Service(std::move(setup)));
  const DaemonConfig& config = service->setup_.config;
  const Site& site = service->setup_.site;
  service->status_.started = system_now();

  DeviceEstimator::Options estimation;
  estimation.localizer.accuracy_confidence = config.engine.accuracy_confidence;
  Expected<std::unique_ptr<DeviceEstimator>> estimator = DeviceEstimator::create(site, estimation);
  if (!estimator) {
    return tl::make_unexpected(estimator.error());
  }
  service->estimator_ = std::move(*estimator);
  service->status_.estimator = service->estimator_.get();
  service->status_.scene_hash = service->estimator_->room().scene_hash;
  service->status_.calibration_id = service->estimator_->room().calibration_id;

  PublisherOptions publishing;
  publishing.endpoint = config.publish.endpoint;
  publishing.site = site.name;
  publishing.epoch = random_epoch();
  publishing.high_water_mark = static_cast<int>(config.publish.send_high_water_mark);
  Expected<Publisher> publisher = Publisher::bind(publishing);
  if (!publisher) {
    return tl::make_unexpected(publisher.error());
  }
  PublisherStage::Options stage;
  stage.heartbeat = config.publish.heartbeat;
  stage.status = [service = service.get()](Timestamp now) {
    return status_messages(service->status_, now);
  };
  stage.now = system_now;
  service->publisher_ = std::make_unique<PublisherStage>(std::move(*publisher), std::move(stage));

  std::vector<SourceWorker::Input> inputs;
  if (const Expected<void> opened = service->open_sources(inputs); !opened) {
    return tl::make_unexpected(opened.error());
  }
  PipelineOptions options;
  options.burst.length = config.engine.burst;
  options.burst.max_transmitters = config.limits.max_targets;
  options.ring_frames = config.limits.ring_frames;
  service->pipeline_ = std::make_unique<Pipeline>(
      options, std::move(inputs), *service->estimator_, *service->publisher_);
  service->status_.pipeline = service->pipeline_.get();
  service->status_.publisher = service->publisher_.get();
  return service;
}

Expected<void> Service::open_sources(std::vector<SourceWorker::Input>& inputs) {
  for (const SourceConfig& source : setup_.config.sources) {
    Expected<SourceWorker::Input> input = open_source(source, setup_.config, setup_.site);
    if (!input) {
      return tl::make_unexpected(input.error());
    }
    if (!setup_.config.record.directory.empty()) {
      Expected<std::unique_ptr<RecorderStage>> recorder = open_recorder(
          recording_path(setup_.config.record.directory, source.access_point, status_.started));
      if (!recorder) {
        return tl::make_unexpected(recorder.error());
      }
      input->tap = recorder->get();
      status_.recorders.push_back(recorder->get());
      recorders_.push_back(std::move(*recorder));
    }
    status_.live.push_back(is_live(source));
    inputs.push_back(std::move(*input));
  }
  return {};
}

Service::~Service() = default;

void Service::start() {
  publisher_->start();
  pipeline_->start();
}

void Service::stop(const std::string& reason, std::chrono::milliseconds patience) {
  auto drained = std::async(std::launch::async, [this] { pipeline_->stop(); });
  if (drained.wait_for(patience) == std::future_status::timeout) {
    pipeline_->hurry();
  }
  drained.wait();
  for (const auto& recorder : recorders_) {
    recorder->finish();
  }
  publisher_->finish(reason);
}

std::vector<std::string> Service::source_descriptions() const {
  std::vector<std::string> lines;
  for (const SourceReport& report : pipeline_->source_reports()) {
    lines.push_back(report.access_point + ": " + report.description);
  }
  return lines;
}

std::vector<std::string> Service::new_warnings() {
  const auto now = std::chrono::steady_clock::now();
  std::vector<std::string> fresh;
  for (const CalibrationWarning& warning : estimator_->calibration_warnings()) {
    const auto told =
        std::find_if(told_warnings_.begin(), told_warnings_.end(), [&](const ToldWarning& one) {
          return one.warning.same_as(warning);
        });
    if (told == told_warnings_.end()) {
      told_warnings_.push_back({warning, now});
    } else if (now - told->time >= kRepeatWarning) {
      told->time = now;
    } else {
      continue;
    }
    fresh.push_back(warning.text);
  }
  return fresh;
}

std::vector<std::string> Service::new_errors() {
  std::vector<std::string> errors;
  for (const SourceReport& report : pipeline_->source_reports()) {
    if (!report.error.empty()) {
      errors.push_back("source " + report.access_point + " has ended: " + report.error);
    }
  }
  for (const auto& recorder : recorders_) {
    if (const std::string error = recorder->counters().error; !error.empty()) {
      errors.push_back("recording: " + error);
    }
  }
  std::vector<std::string> fresh;
  for (const std::string& error : errors) {
    if (std::find(told_errors_.begin(), told_errors_.end(), error) == told_errors_.end()) {
      fresh.push_back(error);
      told_errors_.push_back(error);
    }
  }
  return fresh;
}

}  // namespace rayloc
