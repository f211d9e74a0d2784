#include "daemon/lab/recordings/unsited_frames.h"

#include <chrono>
#include <string_view>

#include "capture/decode/decoder_registry.h"
#include "capture/source/recorded_source.h"
#include "capture/source/rejection_words.h"

namespace rayloc {

std::string recording_name(const RecordingArgument& recording) {
  return recording.access_point.empty() ? recording.files.front() : recording.access_point;
}

Expected<void> read_unsited_frames(
    const RecordingArgument& recording,
    const CsiReceiverOptions& options,
    const std::function<Expected<void>(std::vector<CsiFrame>& frames)>& take,
    FrameSummary& summary,
    std::vector<std::string>& notes) {
  auto source = RecordedSource::open(recording.files, as_stamped_options());
  RAYLOC_TRY(source);
  CsiReceiver receiver(options);
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
    RAYLOC_TRY(take(frames));
    frames.clear();
  }
  summary.add((*source)->counters(), receiver.counters());
  for (const auto& lines : {describe((*source)->plan()),
                            (*source)->warnings(),
                            rejection_words(receiver.counters().rejected,
                                            receiver.counters().received,
                                            (*source)->description())}) {
    notes.insert(notes.end(), lines.begin(), lines.end());
  }
  return result;
}

Expected<void> check_wire_format(const std::string& format) {
  if (format.empty() || is_wire_format(format)) {
    return {};
  }
  std::string known;
  for (const std::string_view name : wire_formats()) {
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  return make_error(ErrorKind::kUsage,
                    "--format " + format + ": there is no such format; one of " + known);
}

Expected<void> check_summary(const FrameSummary& summary) {
  if (summary.datagrams > 0 && summary.decoded == 0) {
    return bad_input("no CSI in " + std::to_string(summary.datagrams) +
                     " packets; the summary states why each was rejected");
  }
  return {};
}

}  // namespace rayloc
