// `rayloc frames`: prints the CSI frames of recordings, one per line.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "capture/assemble/csi_receiver.h"
#include "capture/decode/decoder_registry.h"
#include "capture/source/recorded_source.h"
#include "capture/source/rejection_words.h"
#include "daemon/base/arrays/npz_file.h"
#include "daemon/cli/command/verb.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/frame_arrays.h"
#include "daemon/lab/recordings/time_text.h"

namespace rayloc::cli {
namespace {

using Json = nlohmann::ordered_json;

struct FramesOptions {
  std::vector<std::string> captures;
  std::string format;
  std::string out;
  bool json = false;
  bool values = false;
  bool raw = false;
  bool quiet = false;
};

// Outcome of all datagrams: datagrams = decoded + sum(rejected).
struct Summary {
  std::uint64_t datagrams = 0;
  std::uint64_t decoded = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t late = 0;
  std::uint64_t frames = 0;
  std::uint64_t partial = 0;
  std::uint64_t unrecorded = 0;  // from gap marks in the recordings; not part of datagrams
  std::map<std::string, std::uint64_t> rejected;

  void add(const SourceCounters& source, const CsiReceiverCounters& receiver) {
    datagrams += source.received;
    decoded += receiver.in_frames + receiver.duplicates + receiver.late;
    duplicates += receiver.duplicates;
    late += receiver.late;
    frames += receiver.frames;
    partial += receiver.partial;
    unrecorded += source.unrecorded;
    for (const auto& counts : {source.rejected, receiver.rejected}) {
      for (const auto& [reason, count] : counts) {
        rejected[reason] += count;
      }
    }
  }
};

Json values_of(const CsiFrame& frame) {
  Json cores = Json::array();
  for (std::size_t core = 0; core < frame.csi.antennas(); ++core) {
    Json streams = Json::array();
    for (std::size_t stream = 0; stream < frame.csi.streams(); ++stream) {
      Json tones = Json::array();
      for (const std::complex<float> h : frame.csi.row(core, stream)) {
        tones.push_back(Json::array({h.real(), h.imag()}));
      }
      streams.push_back(std::move(tones));
    }
    cores.push_back(std::move(streams));
  }
  return cores;
}

std::string json_line(const CsiFrame& frame, const std::string& access_point, bool values) {
  Json power = Json::array();
  for (const std::optional<float>& dbm : frame.power_dbm) {
    power.push_back(dbm ? Json(*dbm) : Json(nullptr));
  }
  Json line = {{"time", time_text(frame.time)},
               {"ap", access_point},
               {"transmitter", to_string(frame.transmitter)},
               {"format", frame.format},
               {"phy", to_string(frame.phy)},
               {"bandwidth_mhz", frame.bandwidth_mhz},
               {"sequence", frame.sequence},
               {"sequence_control", frame.sequence_control},
               {"cores", frame.cores},
               {"streams", frame.csi.streams()},
               {"tones", frame.csi.tones()},
               {"power_dbm", std::move(power)},
               {"complete", frame.complete},
               {"flags", frame.flags}};
  if (frame.channel) {
    line["centre_hz"] = frame.channel->centre_hz;
  }
  if (values) {
    line["tone_index"] = frame.tone_index;
    line["csi"] = values_of(frame);
  }
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string text_line(const CsiFrame& frame, const std::string& access_point) {
  std::string cores;
  std::string power;
  for (std::size_t i = 0; i < frame.cores.size(); ++i) {
    cores += (i == 0 ? "" : ",") + std::to_string(frame.cores[i]);
    power += i == 0 ? "" : ",";
    power += frame.power_dbm[i] ? std::to_string(static_cast<int>(*frame.power_dbm[i])) : "?";
  }
  std::string line = time_text(frame.time) + "  " + access_point + "  " +
                     to_string(frame.transmitter) + "  " + std::string(frame.format) + "  " +
                     std::string(to_string(frame.phy)) + " " + std::to_string(frame.bandwidth_mhz) +
                     " MHz  sequence " + std::to_string(frame.sequence) + "/" +
                     std::to_string(frame.sequence_control) + "  cores " + cores + "  streams " +
                     std::to_string(frame.csi.streams()) + "  tones " +
                     std::to_string(frame.csi.tones()) + "  " + power + " dBm";
  line += frame.complete ? "" : "  incomplete";
  for (const std::string_view flag : frame.flags) {
    line += "  " + std::string(flag);
  }
  return line;
}

std::string summary_line(const Summary& summary, bool json) {
  if (json) {
    return Json{{"summary",
                 {{"datagrams", summary.datagrams},
                  {"decoded", summary.decoded},
                  {"duplicates", summary.duplicates},
                  {"late", summary.late},
                  {"frames", summary.frames},
                  {"partial", summary.partial},
                  {"unrecorded", summary.unrecorded},
                  {"rejected", summary.rejected}}}}
        .dump();
  }
  std::string line = std::to_string(summary.datagrams) + " datagrams, " +
                     std::to_string(summary.decoded) + " decoded (" +
                     std::to_string(summary.duplicates) + " duplicates, " +
                     std::to_string(summary.late) + " late), " + std::to_string(summary.frames) +
                     " frames, " + std::to_string(summary.partial) + " partial";
  for (const auto& [reason, count] : summary.rejected) {
    line += ", " + std::to_string(count) + " rejected: " + reason;
  }
  if (summary.unrecorded > 0) {
    line += "; marked in the recording as not recorded: " + std::to_string(summary.unrecorded);
  }
  return line;
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Expected<File> open_output(const std::string& path) {
  if (path.empty() || is_npz(path)) {
    return File(stdout, [](std::FILE*) { return 0; });
  }
  File file(std::fopen(path.c_str(), "w"), std::fclose);
  if (file == nullptr) {
    return make_error(ErrorKind::kUnavailable, path + ": cannot be written; choose another --out");
  }
  return file;
}

Expected<void> write_frame_line(std::FILE* out, const std::string& line) {
  if (std::fputs(line.c_str(), out) < 0 || std::fputc('\n', out) == EOF) {
    return make_error(ErrorKind::kUnavailable, "the output cannot be written");
  }
  return {};
}

Expected<void> print_frames(const std::vector<CsiFrame>& frames,
                            const std::string& access_point,
                            const FramesOptions& options,
                            std::FILE* out) {
  for (const CsiFrame& frame : frames) {
    Expected<void> printed = write_frame_line(out,
                                              options.json || options.values
                                                  ? json_line(frame, access_point, options.values)
                                                  : text_line(frame, access_point));
    if (!printed) {
      return printed;
    }
  }
  if (std::fflush(out) != 0) {  // for a concurrent reader of the output
    return make_error(ErrorKind::kUnavailable, "the output cannot be written");
  }
  return {};
}

// Content of an .npz, complete once all frames are read.
struct Collected {
  std::vector<CsiFrame> frames;
  std::vector<std::string> access_points;
};

Expected<void> take_frames(std::vector<CsiFrame>& frames,
                           const std::string& access_point,
                           const FramesOptions& options,
                           std::FILE* out,
                           Collected& collected) {
  if (!is_npz(options.out)) {
    return print_frames(frames, access_point, options, out);
  }
  std::move(frames.begin(), frames.end(), std::back_inserter(collected.frames));
  return {};
}

Expected<void> run_recording(const RecordingArgument& recording,
                             const FramesOptions& options,
                             std::FILE* out,
                             Summary& summary,
                             Collected& collected) {
  auto source = RecordedSource::open(recording.files, as_stamped_options());
  if (!source) {
    return tl::make_unexpected(source.error());
  }
  CsiReceiverOptions receiver_options;
  receiver_options.format = options.format;
  receiver_options.raw = options.raw;
  receiver_options.access_point = static_cast<int>(collected.access_points.size());
  CsiReceiver receiver(receiver_options);
  const std::string access_point =
      recording.access_point.empty() ? recording.files.front() : recording.access_point;
  collected.access_points.push_back(access_point);
  DatagramBatch batch;
  std::vector<CsiFrame> frames;
  Expected<void> result;
  while (result && !batch.ended) {
    result = (*source)->read(batch, std::chrono::seconds(1));
    if (!result) {
      batch.datagrams.clear();
    }
    for (const Datagram& datagram : batch.datagrams) {
      receiver.push(datagram, frames);
    }
    if (!result || batch.ended) {
      receiver.flush(frames);
    }
    Expected<void> printed = take_frames(frames, access_point, options, out, collected);
    if (!printed) {
      return printed;
    }
    frames.clear();
  }
  summary.add((*source)->counters(), receiver.counters());
  for (const auto& words : {describe((*source)->plan()),
                            (*source)->warnings(),
                            rejection_words(receiver.counters().rejected,
                                            receiver.counters().received,
                                            (*source)->description())}) {
    for (const std::string& line : words) {
      if (!options.quiet) {
        std::fprintf(stderr, "rayloc: %s\n", line.c_str());
      }
    }
  }
  return result;
}

Expected<void> run_frames(const FramesOptions& options) {
  if (!options.format.empty() && !is_wire_format(options.format)) {
    std::string known;
    for (const std::string_view name : wire_formats()) {
      known += (known.empty() ? "" : ", ") + std::string(name);
    }
    return make_error(ErrorKind::kUsage,
                      "--format " + options.format + ": there is no such format; one of " + known);
  }
  auto out = open_output(options.out);
  if (!out) {
    return tl::make_unexpected(out.error());
  }
  Summary summary;
  Collected collected;
  Expected<void> result;
  for (const RecordingArgument& recording : recordings_of_any(options.captures)) {
    result = run_recording(recording, options, out->get(), summary, collected);
    if (!result) {
      break;
    }
  }
  if (result && is_npz(options.out)) {
    result = write_npz(frame_arrays(collected.frames), collected.access_points, options.out);
  }
  Expected<void> printed =
      write_frame_line(out->get(), summary_line(summary, options.json || options.values));
  if (result && !printed) {
    return printed;
  }
  if (result && summary.datagrams > 0 && summary.decoded == 0) {
    return bad_input("no CSI in " + std::to_string(summary.datagrams) +
                     " packets; the summary states why each was rejected");
  }
  return result;
}

RunVerb declare_frames(OptionParser& app) {
  const auto options = std::make_shared<FramesOptions>();
  app.add_option(
         "captures",
         options->captures,
         "recordings: [AP=]FILE, pcap or pcapng, .gz, -; several of one AP are a sequence in "
         "order of time")
      ->required();
  app.add_flag("--json", options->json, "a JSON object a line");
  app.add_flag("--values", options->values, "with tone_index and csi; implies --json");
  app.add_flag(
      "--raw", options->raw, "CSI as on the wire: FFT order, rotated, with unusable tones");
  app.add_option("--format", options->format, "wire format, instead of recognising it");
  app.add_option(
      "--out",
      options->out,
      "write there instead of to stdout; FILE.npz: all frames as arrays of numpy (csi and mask "
      "[frame][core][tone] of the first stream, headers, power_dbm, cores, tone_index, "
      "access_points)");
  app.add_flag("--quiet", options->quiet, "no words on stderr");
  return [options] { return run_frames(*options); };
}

}  // namespace

extern const Verb kFrames;
const Verb kFrames = {"frames",
                      "List the CSI frames of recordings",
                      "rayloc frames --json ap1=recording.pcap.gz | jq .power_dbm",
                      declare_frames};

}  // namespace rayloc::cli
