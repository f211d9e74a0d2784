#include "daemon/live/cluster/operate/stream_check.h"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/live/cluster/cluster_names.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr double kNearlyFull = 0.8;  // share of the account's storage limit

}  // namespace

RequiredStream required_claim_stream() {
  return {std::string(kClaimStream), std::string(kClaimsAgain), 1};
}

RequiredStream required_output_stream() {
  return {std::string(kOutputStream), std::string(kOutputAgain), 0};
}

RequiredStream required_csi_stream(const std::string& site) {
  return {csi_stream(site), live_subjects(site), 0};
}

std::vector<Finding> check_stream(const RequiredStream& required,
                                  const std::vector<StreamReport>& streams,
                                  bool has_several_servers) {
  const std::string what = "stream " + required.name;
  const auto stream = std::find_if(streams.begin(), streams.end(), [&](const StreamReport& one) {
    return one.options.name == required.name;
  });
  if (stream == streams.end()) {
    return {Finding::problem(what + " does not exist", "start a worker, which creates it")};
  }
  std::vector<Finding> findings;
  for (const std::string& trouble : stream->troubles) {
    findings.push_back(Finding::problem(what + ": " + printable(trouble),
                                        "wait for that server, or remove it from the cluster"));
  }
  if (!stream->answers_directly || stream->options.republish_to != required.republish_to ||
      stream->options.max_messages_per_subject != required.messages_per_subject) {
    findings.push_back(
        Finding::problem(what + " was not created by raylocd: workers cannot read it",
                         "delete it (nats stream rm " + required.name +
                             "); raylocd creates it again when it needs it"));
  } else if (has_several_servers && stream->options.replicas == 1) {
    findings.push_back(Finding::warning(what + " has a single replica",
                                        "set replicas = 3 in [cluster], and run nats stream edit " +
                                            required.name + " --replicas 3"));
  } else if (stream->troubles.empty()) {
    findings.push_back(Finding::ok(fmt::format("{}: {} replicas in {}",
                                               what,
                                               stream->options.replicas,
                                               stream->options.in_memory ? "memory" : "files")));
  }
  return findings;
}

std::vector<Finding> check_store(const StoreReport& store) {
  std::vector<Finding> findings;
  const auto check = [&](const char* what, std::uint64_t used, std::int64_t most) {
    if (most > 0 && static_cast<double>(used) > kNearlyFull * static_cast<double>(most)) {
      findings.push_back(
          Finding::warning(fmt::format("streams in {} use {} of {} MiB",
                                       what,
                                       used >> 20U,
                                       static_cast<std::uint64_t>(most) >> 20U),
                           "raise the limit in jetstream { }, or reduce retention_s"));
    }
  };
  check("memory", store.memory, store.most_memory);
  check("files", store.files, store.most_files);
  return findings;
}

}  // namespace rayloc
