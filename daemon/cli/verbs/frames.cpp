// `rayloc frames`: prints the CSI frames of recordings, one per line.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/report/frame_output.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/frame_summary.h"
#include "daemon/lab/recordings/unsited_frames.h"

namespace rayloc::cli {
namespace {

struct FramesOptions {
  std::vector<std::string> captures;
  std::string format;
  FrameOutputOptions output;
  bool raw = false;
  bool quiet = false;
};

Expected<void> run_recording(const RecordingArgument& recording,
                             const FramesOptions& options,
                             FrameOutput& out,
                             FrameSummary& summary) {
  const std::string access_point = recording_name(recording);
  CsiReceiverOptions receiver;
  receiver.format = options.format;
  receiver.raw = options.raw;
  receiver.access_point = out.add_access_point(access_point);
  std::vector<std::string> notes;
  Expected<void> result = read_unsited_frames(
      recording,
      receiver,
      [&](std::vector<CsiFrame>& frames) { return out.write(frames, access_point); },
      summary,
      notes);
  if (!options.quiet) {
    for (const std::string& note : notes) {
      std::fprintf(stderr, "rayloc: %s\n", note.c_str());
    }
  }
  return result;
}

Expected<void> run_frames(const FramesOptions& options) {
  RAYLOC_TRY(check_wire_format(options.format));
  auto out = FrameOutput::open(options.output);
  RAYLOC_TRY(out);
  FrameSummary summary;
  Expected<void> result;
  for (const RecordingArgument& recording : recordings_of_any(options.captures)) {
    result = run_recording(recording, options, *out, summary);
    if (!result) {
      break;
    }
  }
  if (result) {
    result = out->write_arrays();
  }
  Expected<void> printed = out->write_summary(summary);
  if (result && !printed) {
    return printed;
  }
  return result ? check_summary(summary) : result;
}

RunVerb declare_frames(OptionParser& app) {
  const auto options = std::make_shared<FramesOptions>();
  app.add_option(
         "captures",
         options->captures,
         "recordings: [AP=]FILE, pcap or pcapng, .gz, -; several of one AP are a sequence in "
         "order of time")
      ->required();
  app.add_flag("--json", options->output.json, "a JSON object a line");
  app.add_flag("--values", options->output.values, "with tone_index and csi; implies --json");
  app.add_flag(
      "--raw", options->raw, "CSI as on the wire: FFT order, rotated, with unusable tones");
  app.add_option("--format", options->format, "wire format, instead of recognising it");
  app.add_option(
      "--out",
      options->output.file,
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
