#include "daemon/site/survey/survey_listener.h"

#include <algorithm>
#include <utility>

#include "capture/source/transport_schemes.h"
#include "daemon/site/model/receiver_options.h"

namespace rayloc {

Expected<SurveyListener> SurveyListener::open(const Site& site,
                                              const std::vector<SurveyPort>& ports) {
  SurveyListener listener(&site);
  for (const SurveyPort& wanted : ports) {
    const SiteAccessPoint& ap = site.access_points[wanted.access_point];
    const auto where = parse_transport(transport_schemes(), wanted.address, "udp");
    if (where && !where->scheme->live) {
      return make_error(ErrorKind::kUsage,
                        wanted.address + ": is over already; listen at " +
                            transport_syntax(transport_schemes(), TransportUse::kLiveSource));
    }
    auto source = open_datagram_source(transport_schemes(), wanted.address, "udp");
    RAYLOC_TRY(source);
    Port port{ap.id,
              ap.rx_chains,
              std::move(*source),
              CsiReceiver(receiver_options(site, wanted.access_point)),
              nullptr,
              0};
    if (!wanted.recording.empty()) {
      auto recorder = open_datagram_sink(transport_schemes(), wanted.recording, "pcap");
      RAYLOC_TRY(recorder);
      port.recorder = *std::move(recorder);
    }
    listener.ports_.push_back(std::move(port));
  }
  return listener;
}

// As in a calibration: if the site lists devices, no other phone counts.
bool SurveyListener::is_surveyed(const MacAddress& transmitter) const {
  const SiteTransmitter* stated = find_transmitter(*site_, transmitter);
  if (stated != nullptr) {
    return stated->role == TransmitterRole::kDevice;
  }
  return std::none_of(
      site_->transmitters.begin(), site_->transmitters.end(), [](const SiteTransmitter& one) {
        return one.role == TransmitterRole::kDevice;
      });
}

bool SurveyListener::counts_as_whole(const Port& port, const CsiFrame& frame) const {
  if (!is_surveyed(frame.transmitter)) {
    return false;
  }
  return std::all_of(port.rx_chains.begin(), port.rx_chains.end(), [&](std::uint8_t rx_chain) {
    return std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chain) !=
           frame.rx_chains.end();
  });
}

Expected<void> SurveyListener::listen(Duration timeout) {
  for (Port& port : ports_) {
    DatagramBatch batch;
    RAYLOC_TRY(port.source->read(batch, timeout));
    std::vector<CsiFrame> frames;
    for (const Datagram& datagram : batch.datagrams) {
      port.receiver.push(datagram, frames);
    }
    port.receiver.advance(batch.watermark, frames);
    if (port.recorder && !batch.datagrams.empty()) {
      RAYLOC_TRY(port.recorder->write(batch));
    }
    for (const CsiFrame& frame : frames) {
      if (frame.time >= start_ && counts_as_whole(port, frame)) {
        ++port.count;
      }
    }
  }
  return {};
}

void SurveyListener::start_counting(Timestamp start) {
  start_ = start;
  for (Port& port : ports_) {
    port.count = 0;
  }
}

std::vector<std::size_t> SurveyListener::counts() const {
  std::vector<std::size_t> counts;
  for (const Port& port : ports_) {
    counts.push_back(port.count);
  }
  return counts;
}

Expected<void> SurveyListener::finish() {
  Expected<void> result;
  for (Port& port : ports_) {
    if (port.recorder) {
      if (auto synced = port.recorder->sync(); result && !synced) {
        result = synced;
      }
    }
  }
  return result;
}

}  // namespace rayloc
