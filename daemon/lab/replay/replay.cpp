#include "daemon/lab/replay/replay.h"

#include <cstddef>
#include <utility>

#include "daemon/pipeline/method_receiver.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/zones/zone_estimator.h"
#include "daemon/site/model/site_lacks.h"

namespace rayloc::replay {
namespace {

// Frame limit of a burst at an access point: above the number that any access point sends in it.
constexpr std::size_t kEveryFrame = 4096;

// Passes carried records on beside ordered locations.
class ReplaySink : public OrderedSink {
 public:
  ReplaySink(const Output& output, Duration lag)
      : OrderedSink(output.on_location, output.on_zone_event, lag),
        on_carried_(output.on_carried) {}
  void carried(Carried&& carried) override {
    if (on_carried_) {
      on_carried_(carried);
    }
  }

 private:
  std::function<void(const Carried&)> on_carried_;
};

PipelineOptions pipeline_options(const Options& replay) {
  PipelineOptions options;
  options.burst.length = replay.burst;
  options.overflow = Overflow::kWait;
  if (replay.estimators.method->needs_every_frame) {
    options.burst.max_frames = kEveryFrame;
  }
  return options;
}

}  // namespace

Expected<Prepared> prepare(const Site& site,
                           const Options& options,
                           const Recordings& recordings,
                           const WarmOptions& warm,
                           const Observer& observer) {
  auto start = warm_start_of(warm);
  RAYLOC_TRY(start);
  auto inputs = open_inputs(recordings, site, *options.estimators.method, start->listen_from);
  RAYLOC_TRY(inputs);
  auto estimators = make_estimators(options.estimators, site, start->carried, observer);
  RAYLOC_TRY(estimators);
  return Prepared{site, options, *std::move(start), *std::move(inputs), *std::move(estimators)};
}

Summary run(Prepared& replay, Duration carry_every, const Output& output) {
  PipelineOptions options = pipeline_options(replay.options);
  options.open = replay.start.open;
  options.from = replay.start.from;
  options.carry_every = carry_every;
  ZoneEstimator zones(replay.estimators.all, replay.site.zones, replay.start.carried.get());
  ReplaySink sink(output, replay.options.estimators.method->lag);
  Pipeline pipeline(options, std::move(replay.inputs.inputs), zones, sink);
  pipeline.start();
  pipeline.wait();
  sink.finish();
  const auto sources = std::move(replay.inputs.sources);  // they point into the pipeline
  replay.inputs.sources.clear();
  return summarize(pipeline, sources);
}

Notices take_notices(Prepared& replay) {
  Notices notices;
  if (!replay.estimators.devices) {  // with people only, each estimate reports what is missing
    notices.chains = replay.estimators.people->chain_notices();
    return notices;
  }
  DeviceEstimator& devices = *replay.estimators.devices;
  notices.chains = devices.chain_notices();
  notices.chain_progress = devices.chain_progress();
  const SiteLacks lacks = site_lacks(replay.site, devices.room(), replay.inputs.access_points);
  notices.lacks = replay.options.estimators.kind == Kind::kAll ? lacks.all() : lacks.obstacles;
  return notices;
}

Expected<void> run_streams(const Site& site,
                           const Options& options,
                           Streams streams,
                           LocationSink& sink,
                           const Observer& observer) {
  auto estimators = make_estimators(options.estimators, site, streams.carried, observer);
  RAYLOC_TRY(estimators);
  std::vector<SourceInput> inputs(streams.sources.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    inputs[i].access_point = site.access_points[i].id;
    inputs[i].source = std::move(streams.sources[i]);
    inputs[i].receiver = receiver_options(site, i, options.estimators.method);
  }
  PipelineOptions all = pipeline_options(options);
  all.from = streams.from;
  all.promises_are_kept = true;
  if (streams.carried) {
    all.open = streams.carried->open;
  }
  ZoneEstimator zones(estimators->all, site.zones, streams.carried.get());
  Pipeline pipeline(all, std::move(inputs), zones, sink);
  pipeline.start();
  pipeline.wait();
  return {};
}

void assume_height_sigma(double sigma, Site& site) {
  site.targets.height_sigma = sigma;
  for (SiteTransmitter& transmitter : site.transmitters) {
    transmitter.height_sigma = sigma;
  }
}

}  // namespace rayloc::replay
