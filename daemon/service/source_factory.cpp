#include "daemon/service/source_factory.h"

#include <utility>

#include "capture/pcap_live_source.h"
#include "capture/pcap_source.h"
#include "capture/udp_source.h"
#include "daemon/pipeline/paced_source.h"

namespace rayloc {
namespace {

template <typename Source>
Expected<std::unique_ptr<DatagramSource>> as_datagram_source(
    Expected<std::unique_ptr<Source>> opened) {
  if (!opened) {
    return tl::make_unexpected(opened.error());
  }
  return std::unique_ptr<DatagramSource>(std::move(*opened));
}

std::string listen_address(const SourceConfig& source) {
  const bool ipv6 = source.listen_host.find(':') != std::string::npos;
  return (ipv6 ? "[" + source.listen_host + "]" : source.listen_host) + ":" +
         std::to_string(source.listen_port);
}

Expected<std::unique_ptr<DatagramSource>> open_datagrams(const SourceConfig& source) {
  switch (source.kind) {
    case SourceKind::kUdp: {
      UdpSourceOptions options;
      options.address = listen_address(source);
      return as_datagram_source(UdpSource::open(options));
    }
    case SourceKind::kInterface: {
      PcapLiveOptions options;
      options.interface = source.interface;
      options.filter = source.filter;
      return as_datagram_source(PcapLiveSource::open(options));
    }
    case SourceKind::kPcap: {
      auto file = as_datagram_source(PcapFileSource::open(source.file.string()));
      if (!file || !source.speed) {
        return file;
      }
      return std::unique_ptr<DatagramSource>(
          std::make_unique<PacedSource>(std::move(*file), std::make_shared<Pace>(*source.speed)));
    }
  }
  return make_error(ErrorKind::kInternal, "a kind of source that does not exist");
}

}  // namespace

Expected<SourceWorker::Input> open_source(const SourceConfig& source,
                                          const DaemonConfig& config,
                                          const Site& site) {
  Expected<std::unique_ptr<DatagramSource>> opened = open_datagrams(source);
  if (!opened) {
    Error error = opened.error();
    error.message = config.file.string() + ":" + std::to_string(source.line) + ":" +
                    std::to_string(source.column) + ": " + error.message;
    return tl::make_unexpected(std::move(error));
  }
  const SiteAccessPoint& access_point =
      site.access_points[static_cast<std::size_t>(source.access_point_index)];
  SourceWorker::Input input;
  input.access_point = access_point.id;
  input.source = std::move(*opened);
  input.receiver.access_point = source.access_point_index;
  input.receiver.format = source.format.empty() ? access_point.format : source.format;
  input.receiver.expected_cores = access_point.cores;
  return input;
}

}  // namespace rayloc
