#include "capture/source/rejection_words.h"

#include <array>
#include <utility>

namespace rayloc {
namespace {

constexpr std::string_view kTunnel = "tunnel_";

// Names as people write them.
std::string tunnel_name(std::string_view reason) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 14> kNames = {{
      {"tunnel_6in4", "6in4"},
      {"tunnel_batman", "batman-adv"},
      {"tunnel_erspan", "ERSPAN"},
      {"tunnel_etherip", "EtherIP"},
      {"tunnel_geneve", "GENEVE"},
      {"tunnel_gre", "GRE"},
      {"tunnel_ipip", "IP in IP"},
      {"tunnel_ipsec", "IPsec"},
      {"tunnel_l2tp", "L2TP"},
      {"tunnel_mac_in_mac", "802.1ah"},
      {"tunnel_macsec", "MACsec"},
      {"tunnel_mpls", "MPLS pseudowire"},
      {"tunnel_tzsp", "TZSP"},
      {"tunnel_vxlan", "VXLAN"},
  }};
  for (const auto& [known, name] : kNames) {
    if (known == reason) {
      return std::string(name);
    }
  }
  return std::string(reason.substr(kTunnel.size()));
}

}  // namespace

RejectionAdvice rejection_advice(std::string_view reason) {
  if (reason == "monitor_mode") {
    return {"packets are frames of the air, of an interface in monitor mode: they hold no CSI",
            "capture instead what the access point sends, on the wired interface it sends to: "
            "tcpdump -i "
            "IF -w FILE udp port 5500"};
  }
  if (reason == "ip_fragment") {
    return {
        "packets are fragments: the access point's datagrams are longer than the MTU of a link "
        "on their way, and the parts are not joined",
        "raise the MTU of that link (ip link set IF mtu 1500 or more), or capture in front of "
        "it, where the datagrams are whole"};
  }
  if (reason == "truncated_capture") {
    return {
        "packets were cut by the snapshot length of the capture: their datagrams are lost, and "
        "frames are incomplete or missing",
        "capture whole packets: tcpdump -s 0 -i IF -w FILE udp port 5500"};
  }
  if (reason == "legacy_rate") {
    return {
        "records are of frames at legacy rates (802.11a/b/g), of which this card measures no "
        "CSI",
        "have the transmitter send 802.11n (HT) frames"};
  }
  if (reason == "antenna_permutation") {
    return {
        "records do not state one antenna for each receive chain, so that their chains cannot be "
        "distinguished",
        "connect the antennas that the receiver is set to use and start the card anew; a "
        "converter must keep the antenna field as the card wrote it"};
  }
  if (reason.substr(0, kTunnel.size()) == kTunnel) {
    return {"packets came through a tunnel (" + tunnel_name(reason) +
                "): the datagrams inside are not read",
            "capture on the access point's own interface, or mirror to this machine without the "
            "tunnel"};
  }
  return {};
}

bool is_notable(std::uint64_t packets, std::uint64_t received) {
  return packets > 0 && packets * 10 >= received;
}

namespace {

std::string rejected_line(std::string_view reason,
                          std::uint64_t count,
                          std::uint64_t received,
                          const std::string& name) {
  const RejectionAdvice advice = rejection_advice(reason);
  const std::string begin = name + ": ";
  if (reason == "monitor_mode") {
    return begin + "a capture in monitor mode (" + std::to_string(count) +
           " packets with radiotap or other 802.11 headers): it holds the frames of the air and no "
           "CSI; " +
           advice.advice;
  }
  if (advice.what.empty() || !is_notable(count, received)) {
    return {};
  }
  return begin + std::to_string(count) + " of " + std::to_string(received) + " " + advice.what +
         "; " + advice.advice;
}

std::string unwrapped_line(const std::string& tunnel,
                           std::uint64_t count,
                           const std::string& name) {
  return name + ": " + std::to_string(count) + " datagrams came inside " + tunnel +
         " and were read";
}

}  // namespace

std::vector<std::string> rejection_words(const std::map<std::string, std::uint64_t>& rejected,
                                         std::uint64_t received,
                                         const std::string& name) {
  std::vector<std::string> words;
  for (const auto& [reason, count] : rejected) {
    if (std::string line = rejected_line(reason, count, received, name); !line.empty()) {
      words.push_back(std::move(line));
    }
  }
  return words;
}

std::vector<std::string> rejection_words(const SourceCounters& counters, const std::string& name) {
  std::vector<std::string> words = rejection_words(counters.rejected, counters.received, name);
  if (const auto cut = counters.rejected.find("truncated_capture");
      counters.cut_original > 0 && cut != counters.rejected.end() &&
      is_notable(cut->second, counters.received)) {
    words.push_back(name + ": the longest truncated packet was captured with " +
                    std::to_string(counters.cut_captured) + " of " +
                    std::to_string(counters.cut_original) + " bytes");
  }
  for (const auto& [tunnel, count] : counters.unwrapped) {
    words.push_back(unwrapped_line(tunnel, count, name));
  }
  return words;
}

}  // namespace rayloc
