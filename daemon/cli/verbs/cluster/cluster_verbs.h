// The parts of `rayloc cluster`, each in the file of its name (cluster_doctor.cpp, ...).
#pragma once

#include <string>

#include "daemon/cli/verbs/arguments/broker_options.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

Expected<void> run_cluster_doctor(const BrokerOptions& options);

struct ApplyArguments {
  std::string folder;
  std::string name;  // of the site; empty: from site.toml
  int replicas = 1;
};
Expected<void> run_cluster_apply(const BrokerOptions& options, const ApplyArguments& arguments);

struct FetchArguments {
  std::string folder;
  std::string command;  // run after sites have changed; empty: none
  bool keep_on = false;
};
Expected<void> run_cluster_fetch(const BrokerOptions& options, const FetchArguments& arguments);

}  // namespace rayloc::cli
