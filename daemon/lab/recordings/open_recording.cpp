#include "daemon/lab/recordings/open_recording.h"

#include <string>
#include <utility>
#include <vector>

#include "capture/source/recorded_source.h"
#include "capture/source/transport_schemes.h"

namespace rayloc {

Expected<std::unique_ptr<DatagramSource>> open_recording(const RecordingArgument& recording,
                                                         const SourceOptions& options) {
  const std::vector<std::string>& texts = recording.files;
  std::vector<std::string> files;
  for (const std::string& text : texts) {
    const auto where = parse_transport(transport_schemes(), text, "pcap");
    RAYLOC_TRY(where);
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

}  // namespace rayloc
