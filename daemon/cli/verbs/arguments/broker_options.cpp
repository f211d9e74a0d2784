#include "daemon/cli/verbs/arguments/broker_options.h"

#include <chrono>
#include <string>

#include "daemon/live/cluster/cluster_view.h"

namespace rayloc::cli {

std::shared_ptr<BrokerOptions> add_broker_options(OptionParser& sub) {
  auto options = std::make_shared<BrokerOptions>();
  options->servers = {"nats://127.0.0.1:4222"};
  options->name = "rayloc cluster";
  sub.add_option("--server", options->servers, "The NATS servers of the cluster")
      ->allow_extra_args(false)
      ->capture_default_str();
  add_identity_options(sub, *options);
  return options;
}

void add_identity_options(OptionParser& sub, BrokerOptions& options) {
  sub.add_option(
      "--tls-ca", options.ca_file, "Authority that signed the certificates of the servers");
  sub.add_option("--tls-cert",
                 options.certificate_file,
                 "Certificate of this client, where the servers request one");
  sub.add_option("--tls-key", options.key_file, "Key of that certificate");
  sub.add_option(
      "--nkey", options.nkey_seed_file, "Identity of this client, made by `rayloc keygen --nkey`");
  sub.add_option(
      "--inbox", options.inbox, "Prefix of the subjects of replies, where the servers restrict it");
}

Expected<std::shared_ptr<Broker>> connect(const BrokerOptions& options) {
  constexpr std::chrono::milliseconds kBrokerTimeout{3000};  // for an answer of the broker
  auto broker = open_broker(options);
  if (broker && !wait_for_broker(**broker, kBrokerTimeout)) {
    const std::string refusal = (*broker)->refusal();
    return make_error(ErrorKind::kUnavailable,
                      "no NATS server answers at " + options.servers.front() +
                          (refusal.empty() ? std::string("; give its address by --server")
                                           : ": " + refusal + "; see --tls-ca and --nkey"));
  }
  return broker;
}

}  // namespace rayloc::cli
