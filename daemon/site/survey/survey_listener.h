// SurveyListener: reads the ports of a site's access points: datagrams are decoded and counted, and
// recorded on request.
//
// Read also between points: a port without a reader fills up with old frames. One thread.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/transport/datagram_sink.h"
#include "capture/transport/datagram_source.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc {

struct SurveyPort {
  std::size_t access_point = 0;  // position in the site's list
  std::string address;           // HOST:PORT, or a URL (transport_schemes.h) of a live source
  std::string recording;         // a file to create, or a URL; empty: none
};

class SurveyListener {
 public:
  // `site` must outlive it.
  static Expected<SurveyListener> open(const Site& site, const std::vector<SurveyPort>& ports);

  // Reads the received datagrams; waits for them up to `timeout` for each port.
  Expected<void> listen(Duration timeout);

  // Number of whole frames of devices since `start`, for each port: frames of fixed transmitters,
  // of devices that the site does not list if it lists any, and those that lack a core of the
  // access point, do not count.
  void start_counting(Timestamp start);
  std::vector<std::size_t> counts() const;
  const std::string& access_point(std::size_t port) const { return ports_[port].id; }

  // Syncs the recordings to the disk; an Error if any data could not be written.
  Expected<void> finish();

 private:
  struct Port {
    std::string id;
    std::vector<std::uint8_t> rx_chains;
    std::unique_ptr<DatagramSource> source;
    CsiReceiver receiver;
    std::unique_ptr<DatagramSink> recorder;  // null: no recording
    std::size_t count = 0;
  };

  explicit SurveyListener(const Site* site) : site_(site) {}
  bool is_surveyed(const MacAddress& transmitter) const;
  bool counts_as_whole(const Port& port, const CsiFrame& frame) const;

  const Site* site_;
  std::vector<Port> ports_;
  Timestamp start_ = Timestamp::max();
};

}  // namespace rayloc
