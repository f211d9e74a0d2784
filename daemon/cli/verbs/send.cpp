// `rayloc send`: sends a recording's datagrams to a
// UDP port or another sink, as the access point would.
#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "capture/source/recorded_source.h"
#include "capture/source/transport_schemes.h"
#include "capture/transport/sink_queue.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/recordings/capture_argument.h"

namespace rayloc::cli {
namespace {

struct SendArguments {
  std::vector<std::string> files;
  std::vector<std::string> destinations;
  std::string speed = "1";
  std::optional<double> rate;      // datagrams per second, instead of the recorded times
  std::optional<double> duration;  // seconds
  double max_gap = to_seconds(kMaxGap);
};

// CLOCK_MONOTONIC
Duration monotonic_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::chrono::seconds(now.tv_sec) + Duration(now.tv_nsec);
}

// Returns early when a signal asks to stop.
void sleep_until(Duration monotonic) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(monotonic);
  const timespec until{.tv_sec = seconds.count(), .tv_nsec = (monotonic - seconds).count()};
  while (!StopSignal::requested() &&
         clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

// A sequence of files is one recording; so is the content of other transports.
Expected<std::unique_ptr<DatagramSource>> open_recording(const std::vector<std::string>& texts,
                                                         const SourceOptions& options) {
  std::vector<std::string> files;
  for (const std::string& text : texts) {
    const auto where = parse_transport(transport_schemes(), text, "pcap");
    if (!where) {
      return tl::make_unexpected(where.error());
    }
    if (where->scheme->live) {
      return make_error(
          ErrorKind::kUsage,
          text + ": is no recording; rayloc record --from " + text + " passes on what arrives");
    }
    if (where->scheme->name != "pcap" && texts.size() > 1) {
      return make_error(ErrorKind::kUsage,
                        text + ": only files can be a sequence; give each its own --to");
    }
    files.push_back(where->address);
  }
  if (files.size() == 1) {
    return open_datagram_source(transport_schemes(), texts.front(), "pcap", options);
  }
  PcapFileOptions pcap;
  pcap.max_gap = options.max_gap.value_or(pcap.max_gap);
  return as_transport<DatagramSource>(RecordedSource::open(files, pcap));
}

// The datagram as the access point would send it now.
Datagram sent_now(const DatagramAddress& address, std::span<const std::byte> payload) {
  return {std::chrono::system_clock::now(), address, payload};
}

// Merges several recordings in order of time.
class SentRecordings {
 public:
  static Expected<SentRecordings> open(const std::vector<RecordingArgument>& recordings,
                                       const SourceOptions& options) {
    SentRecordings all;
    for (const RecordingArgument& recording : recordings) {
      auto source = open_recording(recording.files, options);
      if (!source) {
        return tl::make_unexpected(std::move(source.error()));
      }
      for (const std::string& line : (*source)->notices()) {
        std::fprintf(stderr, "rayloc send: %s\n", line.c_str());
      }
      all.files_.push_back({std::move(*source), {}, 0});
    }
    return all;
  }

  struct Next {
    std::size_t file = 0;
    const Datagram* datagram = nullptr;  // nullptr: all files are at their end
  };
  // The earliest datagram; valid until the next call.
  Expected<Next> next() {
    if (last_ != nullptr) {
      ++last_->next;
    }
    Next earliest;
    for (std::size_t i = 0; i < files_.size(); ++i) {
      if (auto filled = files_[i].fill(); !filled) {
        return tl::make_unexpected(std::move(filled.error()));
      }
      const Datagram* candidate = files_[i].front();
      if (candidate != nullptr &&
          (earliest.datagram == nullptr || candidate->time < earliest.datagram->time)) {
        earliest = {i, candidate};
      }
    }
    last_ = earliest.datagram != nullptr ? &files_[earliest.file] : nullptr;
    return earliest;
  }

  // Datagrams rejected while reading, by reason.
  std::map<std::string, std::uint64_t> rejected() const {
    std::map<std::string, std::uint64_t> all;
    for (const File& file : files_) {
      for (const auto& [reason, count] : file.source->counters().rejected) {
        all[reason] += count;
      }
    }
    return all;
  }

  void print_warnings() const {
    for (const File& file : files_) {
      for (const std::string& warning : file.source->warnings()) {
        std::fprintf(stderr, "rayloc send: %s\n", warning.c_str());
      }
    }
  }

 private:
  struct File {
    std::unique_ptr<DatagramSource> source;
    DatagramBatch batch;
    std::size_t next = 0;

    const Datagram* front() const {
      return next < batch.datagrams.size() ? &batch.datagrams[next] : nullptr;
    }
    // Waits while a pipe has no data.
    Expected<void> fill() {
      while (front() == nullptr && !batch.ended && !StopSignal::requested()) {
        if (auto read = source->read(batch, std::chrono::milliseconds(200)); !read) {
          return read;
        }
        next = 0;
      }
      return {};
    }
  };
  std::vector<File> files_;
  File* last_ = nullptr;
};

// Result of the paced sending and its delays.
struct Outcome {
  Duration elapsed{};
  Duration latest{};  // largest delay of a datagram
};

// Prints data for scripts: one JSON object when sending begins, one at the end.
void print_json_line(const nlohmann::ordered_json& line) {
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

void announce(std::optional<Duration> time_offset, const SendArguments& arguments) {
  nlohmann::ordered_json line;
  line["event"] = "start";
  line["time_offset_s"] = nullptr;
  if (time_offset) {
    line["time_offset_s"] = to_seconds(*time_offset);
    std::fprintf(stderr,
                 "rayloc send: time offset %.6f s (wall clock - recording)\n",
                 to_seconds(*time_offset));
  }
  line["to"] = arguments.destinations;
  print_json_line(line);
}

// Announces a skipped gap: the datagrams behind it are sent earlier by that much.
void announce_skipped(Duration gap, Duration skipped, std::optional<Duration> time_offset) {
  nlohmann::ordered_json line;
  line["event"] = "gap";
  line["gap_s"] = to_seconds(gap);
  line["skipped_s"] = to_seconds(skipped);
  line["time_offset_s"] = nullptr;
  if (time_offset) {
    line["time_offset_s"] = to_seconds(*time_offset);
  }
  print_json_line(line);
  std::fprintf(stderr,
               "rayloc send: a gap of %.1f s in the recording, of which %.1f s are waited for (see "
               "--max-gap)\n",
               to_seconds(gap),
               to_seconds(gap - skipped));
}

// Sends each datagram at the recording's time divided by the
// speed (infinite: at once), without the skipped parts of gaps.
Expected<Outcome> send_paced(SentRecordings& recordings,
                             SinkQueue& sender,
                             const SendArguments& arguments,
                             double speed) {
  // Lead time, so that the first datagram is not late.
  constexpr Duration kLead = std::chrono::milliseconds(20);
  const Duration max_gap = from_seconds(arguments.max_gap);
  auto next = recordings.next();
  const Duration begin = monotonic_now() + kLead;
  Timestamp first = next && next->datagram != nullptr ? next->datagram->time : Timestamp{};
  Timestamp latest = first;
  const Timestamp wall = std::chrono::system_clock::now() + kLead;
  // At another speed no single offset converts recorded times to arrival times.
  announce(speed == 1.0 ? std::optional<Duration>(wall - first) : std::nullopt, arguments);
  Outcome outcome;
  const Duration end =
      arguments.duration ? begin + from_seconds(*arguments.duration) : Duration::max();
  while (next && next->datagram != nullptr && !StopSignal::requested()) {
    const Datagram& datagram = *next->datagram;
    if (const Duration gap = datagram.time - latest; gap > max_gap && std::isfinite(speed)) {
      first += gap - max_gap;
      announce_skipped(
          gap, gap - max_gap, speed == 1.0 ? std::optional<Duration>(wall - first) : std::nullopt);
    }
    latest = std::max(latest, datagram.time);
    const Duration due = begin + from_seconds(to_seconds(datagram.time - first) / speed);
    if (due > end) {
      break;
    }
    if (due > monotonic_now()) {
      if (auto flushed = sender.flush(); !flushed) {
        return tl::make_unexpected(std::move(flushed.error()));
      }
      sleep_until(due);
    }
    if (std::isfinite(speed)) {
      outcome.latest = std::max(outcome.latest, monotonic_now() - due);
    }
    if (auto queued = sender.queue(next->file, sent_now(datagram.address, datagram.payload));
        !queued) {
      return tl::make_unexpected(std::move(queued.error()));
    }
    next = recordings.next();
  }
  if (auto flushed = sender.flush(); !flushed) {
    return tl::make_unexpected(std::move(flushed.error()));
  }
  outcome.elapsed = monotonic_now() - begin;
  return next ? Expected<Outcome>(outcome) : tl::make_unexpected(std::move(next.error()));
}

struct KeptDatagram {
  std::size_t file;
  DatagramAddress address;
  std::vector<std::byte> payload;
};

Expected<std::vector<KeptDatagram>> keep_all(SentRecordings& recordings) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 30;
  std::vector<KeptDatagram> all;
  std::size_t bytes = 0;
  for (auto next = recordings.next(); !next || next->datagram != nullptr;
       next = recordings.next()) {
    if (!next) {
      return tl::make_unexpected(std::move(next.error()));
    }
    const auto& payload = next->datagram->payload;
    bytes += payload.size() + sizeof(KeptDatagram);
    if (bytes > kMaxBytes) {
      return make_error(ErrorKind::kUsage,
                        "--rate keeps the recording in memory, at most 1 GiB; send a part of it");
    }
    all.push_back({next->file, next->datagram->address, {payload.begin(), payload.end()}});
  }
  return all;
}

// Sends that many datagrams a second and repeats the recording until the duration ends (once
// without a duration). It counts datagrams due since the beginning: errors do not add up.
Expected<Outcome> send_at_rate(SentRecordings& recordings,
                               SinkQueue& sender,
                               const SendArguments& arguments) {
  // Longest time that datagrams may wait to leave together.
  constexpr Duration kTick = std::chrono::milliseconds(1);
  // A machine that cannot keep the rate does not send much longer than the requested duration.
  constexpr Duration kGrace = std::chrono::milliseconds(100);
  auto kept = keep_all(recordings);
  if (!kept) {
    return tl::make_unexpected(std::move(kept.error()));
  }
  announce(std::nullopt, arguments);
  const double rate = *arguments.rate;
  const std::uint64_t total =
      kept->empty()        ? 0
      : arguments.duration ? static_cast<std::uint64_t>(std::llround(rate * *arguments.duration))
                           : kept->size();
  const auto time_of = [rate](std::uint64_t n) {
    return from_seconds(static_cast<double>(n) / rate);
  };
  const Duration begin = monotonic_now();
  Outcome outcome;
  std::uint64_t sent = 0;
  while (sent < total && !StopSignal::requested()) {
    const Duration elapsed = monotonic_now() - begin;
    if (elapsed > time_of(total) + kGrace) {
      break;
    }
    const auto due = std::min(total, static_cast<std::uint64_t>(to_seconds(elapsed) * rate) + 1);
    if (due > sent) {
      outcome.latest = std::max(outcome.latest, elapsed - time_of(sent));
    }
    // Sends in batches, so that a signal or the end of the time is noticed when far behind.
    for (std::size_t i = 0; i < SinkQueue::kBatch && sent < due; ++i, ++sent) {
      const KeptDatagram& one = (*kept)[sent % kept->size()];
      if (auto queued = sender.queue(one.file, sent_now(one.address, one.payload)); !queued) {
        return tl::make_unexpected(std::move(queued.error()));
      }
    }
    if (auto flushed = sender.flush(); !flushed) {
      return tl::make_unexpected(std::move(flushed.error()));
    }
    if (sent == due && sent < total) {
      sleep_until(begin + std::max(time_of(sent), elapsed + kTick));
    }
  }
  outcome.elapsed = monotonic_now() - begin;
  return outcome;
}

Expected<double> parse_speed(const std::string& text) {
  if (text == "max") {
    return std::numeric_limits<double>::infinity();
  }
  char* end = nullptr;
  const double speed = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(speed) || speed <= 0) {
    return make_error(ErrorKind::kUsage, "--speed " + text + ": write a number above 0, or max");
  }
  return speed;
}

void report_sent(const SinkCounters& sent,
                 const Outcome& outcome,
                 const SentRecordings& recordings) {
  const double elapsed = to_seconds(outcome.elapsed);
  const double rate = elapsed > 0 ? static_cast<double>(sent.delivered) / elapsed : 0;
  nlohmann::ordered_json line;
  line["event"] = "end";
  line["datagrams"] = sent.delivered;
  line["bytes"] = sent.bytes;
  line["elapsed_s"] = elapsed;
  line["rate_hz"] = rate;
  line["late_max_s"] = to_seconds(outcome.latest);
  line["rejected"] = recordings.rejected();
  if (sent.lost() > 0) {
    line["lost"] = sent.lost_by;
  }
  print_json_line(line);
  std::fprintf(stderr,
               "rayloc send: sent %llu datagrams in %.3f s (%.1f/s, at most %.1f ms late)\n",
               static_cast<unsigned long long>(sent.delivered),  // NOLINT(google-runtime-int)
               elapsed,
               rate,
               to_seconds(outcome.latest) * 1e3);
  if (const std::string reasons = rejections_text(recordings.rejected()); !reasons.empty()) {
    std::fprintf(stderr, "rayloc send: packets rejected: %s\n", reasons.c_str());
  }
  if (const std::string reasons = rejections_text(sent.lost_by); !reasons.empty()) {
    std::fprintf(stderr, "rayloc send: not delivered: %s\n", reasons.c_str());
  }
}

Expected<void> run_send(const SendArguments& arguments) {
  const auto speed = parse_speed(arguments.speed);
  if (!speed) {
    return tl::make_unexpected(speed.error());
  }
  const std::vector<RecordingArgument> captures = recordings_of_any(arguments.files);
  if (captures.size() != arguments.destinations.size()) {
    return make_error(ErrorKind::kUsage,
                      std::to_string(captures.size()) + " recordings and " +
                          std::to_string(arguments.destinations.size()) +
                          " destinations; give one --to for each, in the same order (files of one "
                          "access point are one recording: AP=FILE AP=FILE)");
  }
  std::vector<std::unique_ptr<DatagramSink>> sinks;
  for (const std::string& text : arguments.destinations) {
    auto sink = open_datagram_sink(transport_schemes(), text, "udp");
    if (!sink) {
      return tl::make_unexpected(std::move(sink.error()));
    }
    sinks.push_back(*std::move(sink));
  }
  SourceOptions options;
  options.max_gap = from_seconds(arguments.max_gap);
  auto recordings = SentRecordings::open(captures, options);
  if (!recordings) {
    return tl::make_unexpected(std::move(recordings.error()));
  }
  SinkQueue sender(std::move(sinks));
  StopSignal::install();
  prctl(PR_SET_TIMERSLACK, 1);  // wake up on time, not 50 us later
  auto outcome = arguments.rate ? send_at_rate(*recordings, sender, arguments)
                                : send_paced(*recordings, sender, arguments, *speed);
  if (!outcome) {
    return tl::make_unexpected(std::move(outcome.error()));
  }
  const auto synced = sender.sync();
  recordings->print_warnings();
  report_sent(sender.counters(), *outcome, *recordings);
  return synced;
}

RunVerb declare_send(OptionParser& app) {
  auto arguments = std::make_shared<SendArguments>();
  app.add_option("FILE",
                 arguments->files,
                 "Recordings: [AP=]FILE, pcap, pcapng, .gz, or - for standard input. Several of "
                 "one AP are a sequence in order of time")
      ->required();
  app.add_option("--to",
                 arguments->destinations,
                 "HOST:PORT, or " + transport_syntax(transport_schemes(), TransportUse::kSink) +
                     "; one for each recording (or AP), in the order of the first files")
      ->required()
      ->allow_extra_args(false);
  auto* speed = app.add_option("--speed",
                               arguments->speed,
                               "Times the recorded pace, or max (a receiver may lose datagrams)")
                    ->capture_default_str();
  app.add_option("--rate",
                 arguments->rate,
                 "Datagrams per second instead of the recorded pace. With --duration the recording "
                 "is repeated, frame counters and all")
      ->check(positive())
      ->excludes(speed);
  app.add_option("--max-gap",
                 arguments->max_gap,
                 "Seconds of the recording that are waited at most where it holds nothing, or the "
                 "clock was set")
      ->check(in_range(0.1, 1e9))
      ->capture_default_str();
  app.add_option("--duration", arguments->duration, "Stop after so many seconds")
      ->check(positive());
  return [arguments] { return run_send(*arguments); };
}

}  // namespace

extern const Verb kSend;
const Verb kSend{"send",
                 "Send a recording to a UDP port, as the access point would",
                 "rayloc send ap1.pcap ap2.pcap --to 127.0.0.1:5500 --to 127.0.0.1:5501\n"
                 "  rayloc send ap1=ring.pcap0 ap1=ring.pcap1 --to 127.0.0.1:5500",
                 declare_send};

}  // namespace rayloc::cli
