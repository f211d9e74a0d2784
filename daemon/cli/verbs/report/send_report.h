// Prints what `rayloc send` reports: JSON objects for scripts, sentences for people.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "capture/transport/datagram_sink.h"
#include "daemon/pipeline/playback/recording_sender.h"

namespace rayloc::cli {

// Notices and warnings of recordings, on standard error.
void print_send_lines(const std::vector<std::string>& lines);

// Prints an object when sending begins and one for each skipped gap. `destinations`: as stated.
SendObserver send_events(const std::vector<std::string>& destinations);

// Prints the object at the end. `rejected`: datagrams of the recordings that were not sent.
void print_sent(const SinkCounters& sent,
                const SendOutcome& outcome,
                const std::map<std::string, std::uint64_t>& rejected);

}  // namespace rayloc::cli
