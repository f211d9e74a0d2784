// Source of published messages for commands: the endpoint of a running
// raylocd, from now on or with the last message of each topic.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/cli/command/option_parser.h"
#include "daemon/live/publish/subscriber.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct MessageSource {
  std::string endpoint = "tcp://127.0.0.1:5560";
  std::string snapshot;  // endpoint; empty: begin with live messages
  std::chrono::milliseconds patience = std::chrono::seconds(10);  // for the snapshot
  std::string server_key;  // file with the daemon's public key; empty: no CURVE
  std::string key;         // file with our secret key
};

// Adds --endpoint, --snapshot, --server-key and --key.
void add_source_options(OptionParser& app, MessageSource& source);

// Returns the next message, or nothing on a time-out or after a signal was caught.
using Receive = std::function<std::optional<PublishedMessage>(std::chrono::milliseconds timeout)>;

// `topics`: their prefixes.
Expected<Receive> connect(const MessageSource& source, const std::vector<std::string>& topics);

}  // namespace rayloc::cli
