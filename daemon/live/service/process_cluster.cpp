// The part of Process that makes it a machine of a cluster.
#include <utility>

#include "daemon/live/health/readiness.h"
#include "daemon/live/service/cluster_options.h"
#include "daemon/live/service/process.h"

namespace rayloc {

Expected<void> Process::open_cluster() {
  const ClusterConfig& config = setup_.config.cluster;
  if (config.role == ClusterRole::kNone) {
    return {};
  }
  auto broker = open_broker(broker_options(config));
  RAYLOC_TRY(broker);
  broker_ = std::move(*broker);
  if (config.role == ClusterRole::kWorker) {
    return open_claims();
  }
  if (config.role == ClusterRole::kGateway) {
    auto gateway = GatewayRole::open(broker_, output_stream(result_options(config)));
    RAYLOC_TRY(gateway);
    gateway_ = std::move(*gateway);
    replicas_ = std::make_unique<ReplicaWatch>(broker_);
    return {};
  }
  CaptureRole::Options options;
  options.node = config.name;
  options.epoch = random_epoch();
  options.sender.flush = config.flush;
  options.sender.limits.window_bytes = config.window_bytes;
  options.sender.limits.keep = config.keep;
  options.sender.limits.keep_bytes = config.keep_bytes;
  options.sender.stream = stream_options(config);
  options.sender.clock_synchronised = [] { return clock_state() == ClockState::kSynchronized; };
  auto capture = CaptureRole::open(broker_, std::move(options));
  RAYLOC_TRY(capture);
  capture_ = std::move(*capture);
  return {};
}

// For workers and gateways; a capture node reports it for each site. The text stays while the
// condition lasts, so that it is reported once.
void Process::check_broker() {
  if (!broker_ || capture_ || broker_->connected()) {
    broker_trouble_.clear();
  } else if (broker_trouble_.empty()) {
    const std::string refusal = broker_->refusal();
    broker_trouble_ = "cluster: no server answers at " + setup_.config.cluster.servers.front() +
                      (refusal.empty() ? "" : " (" + refusal + ")") + "; it is asked again";
  }
}

// For a gateway: it publishes the output of the site's owner.
void Process::listen_to_owner(const std::string& site, std::shared_ptr<SiteOutput> output) {
  gateway_->add(site, [output = std::move(output)](v1::OutputItem&& item) {
    if (item.has_location()) {
      output->relay(std::move(*item.mutable_location()));
    } else if (item.has_track()) {
      output->relay(std::move(*item.mutable_track()));
    } else if (item.has_zone()) {
      output->relay(std::move(*item.mutable_zone()));
    }
  });
}

}  // namespace rayloc
