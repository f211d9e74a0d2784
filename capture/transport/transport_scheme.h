// TransportScheme: one transport of datagrams and its notation for people: "udp:HOST:PORT".
//
// A row is defined beside its implementation; capture/source/transport_schemes.h lists them all.
// Functions that open a source or a sink take the table, so a test can add its own row.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "capture/transport/address_range.h"
#include "capture/transport/datagram_sink.h"
#include "capture/transport/datagram_source.h"

namespace rayloc {

// Options of a source besides its address. A transport that does not support one ignores it: the
// caller that offers an option checks which transports support it.
struct SourceOptions {
  std::string only_interface = {};         // udp: the only accepted interface; empty: all
  std::vector<AddressRange> senders = {};  // udp: the only accepted senders; empty: all
  std::string filter = {};                 // live: a pcap-filter(7); empty: the transport's own
  std::optional<Duration> max_gap = {};    // pcap: PcapFileOptions::max_gap
  int adopted_fd = -1;                     // udp, unix: an open socket to adopt (socket activation)
};

struct TransportScheme {
  std::string_view name;     // "udp"
  std::string_view address;  // the part after the colon: "HOST:PORT"
  std::string_view example;  // "udp:0.0.0.0:5500"
  std::string_view summary;  // one line, a noun phrase
  // Datagrams arrive now, by this machine's clock, without end. Otherwise the input has an end.
  bool live = true;
  // `address` is the part after the colon. Null: the transport does not support this direction.
  Expected<std::unique_ptr<DatagramSource>> (*open_source)(const std::string& address,
                                                           const SourceOptions& options) = nullptr;
  Expected<std::unique_ptr<DatagramSink>> (*open_sink)(const std::string& address) = nullptr;
};

using TransportTable = std::span<const TransportScheme>;

struct TransportAddress {
  const TransportScheme* scheme = nullptr;  // a row of the table
  std::string address;                      // the part after the colon
};

// "SCHEME:ADDRESS". A text that begins with no scheme of the table is the address of
// `plain` if that is not empty ("0.0.0.0:5500" of "udp", "a.pcap" of "pcap"); otherwise
// it is an Error, kUsage, that lists the schemes. REQUIRES: plain is empty or in the
// table.
Expected<TransportAddress> parse_transport(TransportTable table,
                                           const std::string& text,
                                           std::string_view plain = {});

// kUsage if the transport does not support it; otherwise the result of opening it. If a text was
// taken as plain and begins like a scheme, the Error lists the schemes.
Expected<std::unique_ptr<DatagramSource>> open_datagram_source(TransportTable table,
                                                               const std::string& text,
                                                               std::string_view plain = {},
                                                               const SourceOptions& options = {});
Expected<std::unique_ptr<DatagramSink>> open_datagram_sink(TransportTable table,
                                                           const std::string& text,
                                                           std::string_view plain = {});

// For --help and messages: "udp:HOST:PORT, pcap:FILE, unix:PATH or live:INTERFACE", the transports
// that support the use.
enum class TransportUse { kSource, kLiveSource, kSink };
std::string transport_syntax(TransportTable table, TransportUse use);

// Converts an implementation's Expected to that of the rows.
template <typename Base, typename Made>
Expected<std::unique_ptr<Base>> as_transport(Expected<std::unique_ptr<Made>> opened) {
  RAYLOC_TRY(opened);
  return std::unique_ptr<Base>(*std::move(opened));
}

}  // namespace rayloc
