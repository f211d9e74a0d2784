// TransportScheme: one way in which datagrams come or go, and how people write it: "udp:HOST:PORT".
//
// A row stands beside its implementation; capture/source/transport_schemes.h lists all of them.
// What opens a source or a sink is given the table, so a test can add a row of its own.
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

// What one may ask of a source besides its address. A transport that has no such thing ignores it:
// whoever offers the choice to people knows which transports have it.
struct SourceOptions {
  std::string only_interface = {};         // udp: only what arrives there; empty: all
  std::vector<AddressRange> senders = {};  // udp: only what comes from these, when there are any
  std::string filter = {};                 // live: a pcap-filter(7); empty: the transport's own
  std::optional<Duration> max_gap = {};    // pcap: PcapFileOptions::max_gap
  int adopted_fd = -1;  // udp, unix: an open socket to take over (socket activation)
};

struct TransportScheme {
  std::string_view name;     // "udp"
  std::string_view address;  // what follows the colon: "HOST:PORT"
  std::string_view example;  // "udp:0.0.0.0:5500"
  std::string_view summary;  // one line, a noun phrase
  // Its datagrams arrive now, by this machine's clock, and never end. Others are read to their end.
  bool live = true;
  // `address` is what follows the colon. Null: nothing can come or go this way.
  Expected<std::unique_ptr<DatagramSource>> (*open_source)(const std::string& address,
                                                           const SourceOptions& options) = nullptr;
  Expected<std::unique_ptr<DatagramSink>> (*open_sink)(const std::string& address) = nullptr;
};

using TransportTable = std::span<const TransportScheme>;

struct TransportAddress {
  const TransportScheme* scheme = nullptr;  // a row of the table
  std::string address;                      // what follows the colon
};

// "SCHEME:ADDRESS". A text that begins with no scheme of the table is the address of `plain` where
// that is not empty ("0.0.0.0:5500" of "udp", "a.pcap" of "pcap"); else it is an Error, kUsage,
// that lists the schemes there are.
// REQUIRES: plain is empty or in the table.
Expected<TransportAddress> parse_transport(TransportTable table,
                                           const std::string& text,
                                           std::string_view plain = {});

// kUsage where the transport cannot do it; else what opening it says. Where a text was taken as
// plain and begins like a scheme, the Error says which schemes there are.
Expected<std::unique_ptr<DatagramSource>> open_datagram_source(TransportTable table,
                                                               const std::string& text,
                                                               std::string_view plain = {},
                                                               const SourceOptions& options = {});
Expected<std::unique_ptr<DatagramSink>> open_datagram_sink(TransportTable table,
                                                           const std::string& text,
                                                           std::string_view plain = {});

// For --help and messages: "udp:HOST:PORT, pcap:FILE, unix:PATH or live:INTERFACE", of those that
// pass.
enum class TransportUse { kSource, kLiveSource, kSink };
std::string transport_syntax(TransportTable table, TransportUse use);

// An implementation's Expected as the rows have it.
template <typename Base, typename Made>
Expected<std::unique_ptr<Base>> as_transport(Expected<std::unique_ptr<Made>> opened) {
  if (!opened) {
    return tl::make_unexpected(std::move(opened.error()));
  }
  return std::unique_ptr<Base>(*std::move(opened));
}

}  // namespace rayloc
