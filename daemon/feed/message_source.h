// Where verbs take published messages from: a running raylocd's endpoint, from now on or with what
// was last said.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/command/option_parser.h"
#include "daemon/publish/subscriber.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct MessageSource {
  std::string endpoint = "tcp://127.0.0.1:5560";
  std::string snapshot;  // endpoint; empty: begin with what comes
  std::chrono::milliseconds patience = std::chrono::seconds(10);  // for the snapshot
  std::string server_key;  // file with the daemon's public key; empty: no CURVE
  std::string key;         // file with our secret key
};

// Adds --endpoint, --snapshot, --server-key and --key.
void add_source_options(OptionParser& app, MessageSource& source);

// The next message, nothing when none comes for the time given or a signal was caught.
using Receive = std::function<std::optional<PublishedMessage>(std::chrono::milliseconds timeout)>;

// `topics`: what they begin with.
Expected<Receive> connect(const MessageSource& source, const std::vector<std::string>& topics);

}  // namespace rayloc::cli
