#include "daemon/live/machine/source_hints.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "capture/source/rejection_words.h"
#include "capture/source/source_advice.h"

namespace rayloc {
namespace {

using Kind = Finding::Kind;

// Minimum number of frames for a verdict: the first ones are often incomplete.
constexpr std::uint64_t kEnoughFrames = 50;
// An antenna in a fade is 10 to 20 dB below another one for a frame, not on the average of a
// hundred; without its cable a chain receives the others' leakage, 25 dB and more below.
constexpr double kDeafDb = 20.0;
// Reasons of UdpSource for datagrams that the configuration excludes.
constexpr std::string_view kSenderNotAllowed = "sender_not_allowed";
constexpr std::string_view kInterfaceNotAllowed = "interface_not_allowed";
// Reasons of CsiReceiver to reject datagrams of a known format.
constexpr std::string_view kOtherChannel = "other_channel";
constexpr std::string_view kSeveralAccessPoints = "several_access_points";
// Reasons unrelated to the format: stamps and marks of a recording.
constexpr std::array<std::string_view, 10> kNotOfTheFormat = {kSenderNotAllowed,
                                                              kOtherChannel,
                                                              kSeveralAccessPoints,
                                                              kInterfaceNotAllowed,
                                                              "damaged_time",
                                                              "time_went_back",
                                                              "gap_mark",
                                                              "group_address",
                                                              "zero_address",
                                                              "torn_record"};

class Hints {
 public:
  Hints(const v1::SourceState& source, const SiteAccessPoint& stated, const Site& site)
      : source_(source),
        stated_(stated),
        site_(site),
        frames_(source.counters().frames_complete() + source.counters().frames_partial()) {}

  std::vector<Finding> all() {
    silence();
    kept_out(kSenderNotAllowed, "come from addresses that are not allowed", "allow");
    kept_out(kInterfaceNotAllowed, "come through another interface", "only_interface");
    rejected_as_a_whole(kOtherChannel);
    rejected_as_a_whole(kSeveralAccessPoints);
    rejections();
    addresses();
    format();
    if (frames_ >= kEnoughFrames) {
      rx_chains();
      completeness();
      bandwidth();
    }
    return std::move(findings_);
  }

 private:
  void add(Kind kind, const std::string& what, const std::string& advice) {
    findings_.push_back({kind, "source " + source_.access_point() + ": " + what, advice});
  }

  void silence() {
    const std::string hint =
        "see that the access point is on, extracts CSI on the site's channel, sends it to "
        "this machine and port, and that no firewall is in between (tcpdump -n udp)";
    if (source_.status() == v1::SOURCE_STATUS_WAITING && source_.counters().received() == 0) {
      add(Kind::kProblem, "nothing has come yet at " + source_.description(), hint);
    } else if (source_.status() == v1::SOURCE_STATUS_STALLED) {
      add(Kind::kProblem, fmt::format("silent for {} s", source_.age().seconds()), hint);
    } else if (source_.status() == v1::SOURCE_STATUS_FAILED) {
      add(Kind::kProblem, source_.detail(), "");
    }
  }

  // If frames arrive as well, the rejections are intended by the operator.
  void kept_out(std::string_view reason, const char* what, const char* key) {
    const auto found = source_.counters().rejected().find(std::string(reason));
    if (frames_ == 0 && found != source_.counters().rejected().end()) {
      add(Kind::kProblem,
          fmt::format("{} datagrams {}, and no frame has come", found->second, what),
          fmt::format("correct {} in [[source]], if they are the access point's (tcpdump -n udp)",
                      key));
    }
  }

  // A problem while it lasts, a warning once it has ended.
  void rejected_as_a_whole(std::string_view reason) {
    const auto found = source_.counters().rejected().find(std::string(reason));
    if (found == source_.counters().rejected().end()) {
      return;
    }
    const bool goes_on = source_.status() != v1::SOURCE_STATUS_FAILED && !source_.detail().empty();
    add(goes_on ? Kind::kProblem : Kind::kWarning,
        fmt::format("{} datagrams rejected: {}{}{}",
                    found->second,
                    reason,
                    goes_on ? "; " : "",
                    goes_on ? source_.detail() : ""),
        std::string(source_advice(reason)));
  }

  // Tunnels, fragments and other faults of the capture or the network.
  void rejections() {
    for (const auto& [reason, count] : source_.counters().rejected()) {
      const RejectionAdvice advice = rejection_advice(reason);
      if (!advice.what.empty() &&
          (reason == "monitor_mode" || is_notable(count, source_.counters().received()))) {
        add(frames_ == 0 ? Kind::kProblem : Kind::kWarning,
            fmt::format("{} {}", count, advice.what),
            advice.advice);
      }
    }
  }

  void addresses() {
    std::uint64_t refused = 0;
    for (const char* reason : {"group_address", "zero_address"}) {
      const auto found = source_.counters().rejected().find(reason);
      refused += found == source_.counters().rejected().end() ? 0 : found->second;
    }
    if (refused > 0) {
      add(frames_ == 0 ? Kind::kProblem : Kind::kWarning,
          fmt::format("{} of {} datagrams state a group address or zero as their transmitter: no "
                      "device is located by them",
                      refused,
                      source_.counters().received()),
          "see the extractor's filter of addresses; a device that was given such an address on "
          "purpose is stated as [[transmitter]] in site.toml");
    }
  }

  void format() {
    std::uint64_t rejected = 0;
    std::string reasons;
    for (const auto& [reason, count] : source_.counters().rejected()) {
      if (std::find(kNotOfTheFormat.begin(), kNotOfTheFormat.end(), reason) !=
              kNotOfTheFormat.end() ||
          !rejection_advice(reason).what.empty()) {
        continue;
      }
      rejected += count;
      reasons += (reasons.empty() ? "" : ", ") + fmt::format("{} {}", count, reason);
    }
    const std::uint64_t received = source_.counters().received();
    if (rejected > 0 && rejected * 10 >= received) {
      add(frames_ == 0 ? Kind::kProblem : Kind::kWarning,
          fmt::format(
              "{} of {} datagrams are no CSI that is known ({})", rejected, received, reasons),
          "another chip or firmware sends there: see `rayloc frames` of a recording, and format "
          "in [[source]] or site.toml");
    }
    if (!stated_.format.empty() && !source_.format().empty() &&
        stated_.format != source_.format()) {
      add(Kind::kWarning,
          "it sends " + source_.format() + ", the site states " + stated_.format,
          "correct format in site.toml, or the address that this access point sends to");
    }
  }

  void rx_chains() {
    for (const std::uint8_t rx_chain : stated_.rx_chains) {
      const auto found =
          std::find_if(source_.cores().begin(), source_.cores().end(), [&](const auto& report) {
            return report.core() == rx_chain;
          });
      const std::uint64_t received = found == source_.cores().end() ? 0U : found->frames();
      if (received == 0) {
        add(Kind::kProblem,
            fmt::format("no frame has core {}, which site.toml names", rx_chain),
            "add it to the antennas of the extractor (RXANT of config5GHZ.sh, -C of "
            "makecsiparams), check its antenna and pigtail, or correct site.toml");
      } else if (received * 10 < frames_ * 9) {
        add(Kind::kWarning,
            fmt::format("core {} is in {} of {} frames only", rx_chain, received, frames_),
            "datagrams are lost on their way, or the access point is overloaded: lower the rate "
            "of frames");
      } else if (found->below_strongest_db() > kDeafDb) {
        add(Kind::kWarning,
            fmt::format(
                "core {} receives {:.0f} dB less than the strongest: its antenna may be dead",
                rx_chain,
                found->below_strongest_db()),
            "check the antenna and its pigtail; if it has none, take the core out of site.toml");
      }
    }
    for (const v1::CoreReport& report : source_.cores()) {
      if (std::find(stated_.rx_chains.begin(), stated_.rx_chains.end(), report.core()) ==
          stated_.rx_chains.end()) {
        add(Kind::kWarning,
            fmt::format("core {} comes and is not in site.toml", report.core()),
            "add its antenna to site.toml: more antennas locate better");
      }
    }
  }

  void completeness() {
    const std::uint64_t partial = source_.counters().frames_partial();
    if (partial * 10 > frames_) {
      add(Kind::kWarning,
          fmt::format("{} of {} frames lack a part", partial, frames_),
          "see what is lost: rayloc status, and net.core.rmem_max above");
    }
  }

  void bandwidth() {
    std::uint64_t as_stated = 0;
    std::string others;
    for (const auto& [mhz, count] : source_.frames_by_bandwidth_mhz()) {
      if (mhz == static_cast<std::uint32_t>(site_.carrier.bandwidth_mhz)) {
        as_stated = count;
      } else {
        others += (others.empty() ? "" : ", ") + fmt::format("{} with {} MHz", count, mhz);
      }
    }
    if (site_.carrier.bandwidth_mhz > 0 && as_stated * 2 < frames_) {
      add(Kind::kWarning,
          fmt::format("{} of {} frames have the {} MHz of site.toml ({})",
                      as_stated,
                      frames_,
                      site_.carrier.bandwidth_mhz,
                      others.empty() ? "no other" : others),
          "set the same channel and bandwidth on the access point and in [carrier]");
    }
  }

  const v1::SourceState& source_;
  const SiteAccessPoint& stated_;
  const Site& site_;
  const std::uint64_t frames_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> source_hints(const v1::SourceState& source, const Site& site) {
  const auto stated = std::find_if(
      site.access_points.begin(), site.access_points.end(), [&](const SiteAccessPoint& one) {
        return one.id == source.access_point();
      });
  return stated == site.access_points.end() ? std::vector<Finding>{}
                                            : Hints(source, *stated, site).all();
}

}  // namespace rayloc
