// `rayloc cluster`: state of a cluster from its broker, and requests to its workers.
#include <memory>
#include <string>

#include <fmt/format.h>

#include "daemon/cli/verbs/cluster/cluster_verbs.h"
#include "daemon/cli/verbs/report/cluster_report.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/operate/drain_worker.h"
#include "daemon/live/cluster/operate/remove_site.h"
#include "daemon/pipeline/record/system_now.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

Expected<ClusterView> read_cluster(const BrokerOptions& server) {
  const auto broker = connect(server);
  return broker ? inspect_cluster(**broker) : tl::make_unexpected(broker.error());
}

Expected<int> run_status(const BrokerOptions& server) {
  constexpr int kOrphaned = 1;
  const auto view = read_cluster(server);
  RAYLOC_TRY(view);
  fmt::print("{}", workers_text(*view));
  return view->sites_without_owner() == 0 ? 0 : kOrphaned;
}

Expected<void> run_sites(const BrokerOptions& server) {
  const auto view = read_cluster(server);
  RAYLOC_TRY(view);
  fmt::print("{}", sites_text(*view, system_now()));
  return {};
}

Expected<void> run_drain(const BrokerOptions& server, const std::string& worker) {
  const auto broker = connect(server);
  RAYLOC_TRY(broker);
  RAYLOC_TRY(drain_worker(**broker, worker));
  fmt::print("worker {} has given back its sites, and may be stopped\n", printable(worker));
  return {};
}

Expected<void> run_remove(const BrokerOptions& server, const std::string& site) {
  const auto broker = connect(server);
  RAYLOC_TRY(broker);
  RAYLOC_TRY(remove_site(**broker, site));
  fmt::print("site {} is taken out\n", printable(site));
  return {};
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
           : sites.parser->parsed()   ? end(run_sites(*sites.broker))
           : doctor.parser->parsed()  ? end(run_cluster_doctor(*doctor.broker))
           : applies.parser->parsed() ? end(run_cluster_apply(*applies.broker, *apply))
           : removes.parser->parsed() ? end(run_remove(*removes.broker, *removed))
           : fetches.parser->parsed() ? end(run_cluster_fetch(*fetches.broker, *fetch))
                                      : end(run_drain(*drain.broker, *worker));
  };
}

}  // namespace

extern const Verb kCluster;
const Verb kCluster = {"cluster",
                       "See who works for which site of a cluster, and have a worker leave",
                       "rayloc cluster status --server nats://10.0.0.1:4222",
                       declare_cluster};

}  // namespace rayloc::cli
