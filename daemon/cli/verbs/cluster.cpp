// `rayloc cluster`: state of a cluster from its broker, and requests to its workers.
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/cli/verbs/cluster_verbs.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/pipeline/record/system_now.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBrokerTimeout{3000};  // for an answer of the broker
constexpr milliseconds kDrainStep{100};
constexpr milliseconds kDrainPatience{60000};  // longest lease

Expected<ClusterView> read_cluster(const BrokerOptions& server) {
  const auto broker = connect(server);
  return broker ? inspect_cluster(**broker) : tl::make_unexpected(broker.error());
}

Expected<int> run_status(const BrokerOptions& server) {
  constexpr int kOrphaned = 1;
  constexpr std::uint32_t kPermillePerPercent = 10;
  const auto view = read_cluster(server);
  if (!view) {
    return tl::make_unexpected(view.error());
  }
  std::size_t orphans = 0;
  for (const auto& [name, site] : view->sites) {
    orphans += view->has_owner(site.claim) ? 0U : 1U;
  }
  for (const auto& [name, worker] : view->workers) {
    const v1::WorkerState& state = worker.state;
    fmt::print("worker {}: {} sites{}{}{}, load {} %, arithmetic {}\n",
               printable(name),
               state.sites_size(),
               state.capacity() > 0 ? fmt::format(" of at most {}", state.capacity()) : "",
               state.leaving() ? ", gives them back" : "",
               state.shedding() > 0 ? fmt::format(", behind with {}", state.shedding()) : "",
               state.load_permille() / kPermillePerPercent,
               printable(state.arithmetic()));
    for (const v1::StandbyState& one : state.stands_by()) {
      fmt::print("  hot for {}: audit: {} windows compared, {} differ ({} results{})\n",
                 printable(one.site()),
                 one.windows(),
                 one.differing(),
                 one.results(),
                 one.is_late() ? "; begun later than the owner: no positions" : "");
    }
  }
  fmt::print("{} workers, {} sites, {} without a worker\n",
             view->workers.size(),
             view->sites.size(),
             orphans);
  return orphans == 0 ? 0 : kOrphaned;
}

std::string lag_of(const v1::OutputRecord& last) {
  const std::int64_t done = last.has_output() ? last.output().done_us() : last.begin().done_us();
  return done == 0
             ? "no results yet"
             : fmt::format("results complete up to {:.1f} s ago",
                           to_seconds(system_now() - Timestamp(std::chrono::microseconds(done))));
}

Expected<int> run_sites(const BrokerOptions& server) {
  const auto view = read_cluster(server);
  if (!view) {
    return tl::make_unexpected(view.error());
  }
  for (const auto& [name, site] : view->sites) {
    const std::string& worker = site.claim.worker();
    fmt::print("{}: {}, generation {}, {}\n",
               printable(name),
               worker.empty()                ? "no worker has it"
               : view->has_owner(site.claim) ? "worker " + printable(worker)
                                             : "worker " + printable(worker) + " is silent",
               site.claim.generation(),
               lag_of(site.last));
  }
  return 0;
}

// Repeats the request until the worker reports that it has no sites.
Expected<void> ask_to_leave(Broker& broker, const std::string& worker) {
  std::atomic<bool> has_left{false};
  const auto states = broker.subscribe(worker_subject(worker), [&](const BrokerMessage& message) {
    v1::WorkerState state;
    has_left =
        has_left || (unseal(message.data, state) && state.leaving() && state.sites().empty());
  });
  if (!states) {
    return tl::make_unexpected(states.error());
  }
  v1::DrainRequest request;
  request.set_worker(worker);
  const std::string bytes = seal(request);
  const auto deadline = std::chrono::steady_clock::now() + kDrainPatience;
  while (!has_left) {
    if (Expected<void> asked = broker.publish(drain_subject(worker), bytes); !asked) {
      return asked;
    }
    std::this_thread::sleep_for(kDrainStep);
    if (std::chrono::steady_clock::now() > deadline) {
      return make_error(ErrorKind::kUnavailable, "worker '" + worker + "' keeps its sites");
    }
  }
  return {};
}

Expected<int> run_drain(const BrokerOptions& server, const std::string& worker) {
  const auto broker = connect(server);
  if (!broker) {
    return tl::make_unexpected(broker.error());
  }
  const auto view = inspect_cluster(**broker);
  if (!view) {
    return tl::make_unexpected(view.error());
  }
  if (view->workers.count(worker) == 0) {
    return make_error(
        ErrorKind::kUnavailable,
        "worker '" + worker + "' does not report; `rayloc cluster status` lists the workers");
  }
  if (const Expected<void> left = ask_to_leave(**broker, worker); !left) {
    return tl::make_unexpected(left.error());
  }
  fmt::print("worker {} has given back its sites, and may be stopped\n", printable(worker));
  return 0;
}

RunVerb declare_cluster(OptionParser& app) {
  app.require_subcommand(1);
  const auto worker = std::make_shared<std::string>();
  struct Part {
    OptionParser* parser;
    std::shared_ptr<BrokerOptions> broker;
  };
  const auto add = [&](const char* name, const char* summary) {
    OptionParser* const sub = app.add_subcommand(name, summary);
    return Part{sub, add_broker_options(*sub)};
  };
  const Part status = add("status", "The running workers; status 1 where a site has none");
  const Part sites = add("sites", "The owner of each site, and its progress");
  const Part doctor = add("doctor", "Problems of the cluster, and their remedies");
  const Part drain = add("drain", "Have a worker give back its sites before it is stopped");
  drain.parser->add_option("worker", *worker, "its [cluster] name")->required();
  const Part applies = add("apply", "Give a site to all workers, in the place of what they have");
  const auto apply = std::make_shared<ApplyArguments>();
  applies.parser->add_option("SITE", apply->folder, "A directory with site.toml")->required();
  applies.parser->add_option(
      "--name", apply->name, "Name of the site; default: the name in site.toml");
  applies.parser->add_option("--replicas", apply->replicas, "Number of servers that keep it")
      ->check(in_range(1, 5))
      ->capture_default_str();
  const Part removes = add("remove", "Take a site out, with its stream");
  const auto removed = std::make_shared<std::string>();
  removes.parser->add_option("SITE", *removed, "Its name; its capture nodes are stopped")
      ->required();
  const Part fetches = add("fetch", "The sites that were applied, as folders for raylocd");
  const auto fetch = std::make_shared<FetchArguments>();
  fetches.parser
      ->add_option(
          "FOLDER", fetch->folder, "Folder of the sites; raylocd.toml includes FOLDER/*.toml")
      ->required();
  fetches.parser->add_option(
      "--command", fetch->command, "Command that is run when sites have changed");
  fetches.parser->add_flag(
      "--follow", fetch->keep_on, "Continue, and fetch sites that are applied later");
  return [=]() -> Expected<int> {
    const auto end = [](const Expected<void>& done) {
      return done ? Expected<int>(0) : tl::make_unexpected(done.error());
    };
    return status.parser->parsed()    ? run_status(*status.broker)
           : sites.parser->parsed()   ? run_sites(*sites.broker)
           : doctor.parser->parsed()  ? end(run_cluster_doctor(*doctor.broker))
           : applies.parser->parsed() ? end(run_cluster_apply(*applies.broker, *apply))
           : removes.parser->parsed() ? end(run_cluster_remove(*removes.broker, *removed))
           : fetches.parser->parsed() ? end(run_cluster_fetch(*fetches.broker, *fetch))
                                      : run_drain(*drain.broker, *worker);
  };
}

}  // namespace

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

extern const Verb kCluster;
const Verb kCluster = {"cluster",
                       "See who works for which site of a cluster, and have a worker leave",
                       "rayloc cluster status --server nats://10.0.0.1:4222",
                       declare_cluster};

}  // namespace rayloc::cli
