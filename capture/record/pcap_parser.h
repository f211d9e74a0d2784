// PcapParser: parses capture files, classic pcap and pcapng, record by record from the bytes
// available so far: it never blocks, so packets from a pipe are delivered as they arrive.
//
// Classic pcap: microseconds and nanoseconds, both byte orders. pcapng: several sections and
// interfaces (each with its link type, if_tsresol and if_tsoffset), enhanced, simple and old packet
// blocks, both byte orders; other blocks are skipped.
//
// After the last record of a capture another capture may begin, of any of these kinds, as `cat`
// joins them: its header is read like that of a file.
//
// Log of the Intel 5300's CSI tool: records of a length (two bytes, big-endian), a code and its
// data. Those with CSI (0xbb) are packets with the link type kLinkTypeIntel5300, beginning at the
// code; its other notifications (0xc1: copies of frames) are skipped. The time is that of the
// extended header, otherwise the card's clock, whose 32 bits of microseconds begin at 1970 and are
// extended at each overflow.
//
// References: [PCAP] draft-ietf-opsawg-pcap, [PCAPNG] draft-ietf-opsawg-pcapng.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/record/pcap_bytes.h"
#include "capture/record/pcap_packet.h"
#include "capture/record/subsecond_unit.h"

namespace rayloc::pcap {

// A pcapng interface whose time stamps contradict the resolution that it states.
struct MisstatedResolution {
  std::uint32_t interface = 0;
  std::uint8_t stated = 0;    // stated if_tsresol
  std::uint8_t read_as = 0;   // if_tsresol that the stamps indicate
  std::uint64_t packets = 0;  // packets of all such interfaces
};

class PcapParser {
 public:
  // `units`: of the classic headers in the file, as an earlier scan determined them.
  explicit PcapParser(std::vector<TimeUnit> units = {}) : known_units_(std::move(units)) {}

  enum class Status {
    kNeedMore,  // `data` ends inside a record
    kPacket,    // `packet` is filled; its data points into the bytes given
    kOther,     // a header, or a block without a packet
    kError,     // not a capture, or a damaged one: `error` describes it, at the record's first byte
  };
  struct Step {
    Status status = Status::kNeedMore;
    std::size_t size = 0;  // bytes consumed
    Packet packet;
    std::string error;
    bool begins_capture = false;  // a file header, or that of another section
  };

  // Parses the record at the beginning of `data`. After kError it must not be called again.
  Step next(Bytes data);

  // A file header was read: the following bytes are a capture.
  bool recognised() const { return format_ != Format::kUnknown; }

  // The stamps come from a card's counter, which has no date.
  bool has_counter_stamps() const { return has_counter_stamps_; }
  // Units of the classic headers so far.
  const std::vector<SubsecondUnit>& units() const { return units_; }
  // The first such interface, if any.
  const std::optional<MisstatedResolution>& misstated() const { return misstated_; }

 private:
  enum class Format { kUnknown, kClassic, kPcapng, kIntel5300 };
  struct Interface {
    std::uint32_t link_type = 0;
    std::uint32_t snap_length = 0;  // 0: no limit
    std::uint8_t resolution = 6;    // if_tsresol: 10^-6 s
    std::int64_t offset_s = 0;      // if_tsoffset
  };

  Step file_header(Bytes data);
  std::optional<Step> joined_header(Bytes data);
  Step classic_header(Bytes data, ByteOrder order);
  Step classic_record(Bytes data);
  Step intel_record(Bytes data);
  Timestamp intel_time(Bytes record);
  Step block(Bytes data);
  Step section_header(Bytes data);
  Step interface_description(Bytes body);
  Step enhanced_packet(Bytes body);
  Step old_packet(Bytes body);
  Step simple_packet(Bytes body) const;
  Step timed_packet(Bytes body, std::uint32_t interface, std::size_t header);
  std::optional<Timestamp> block_time(std::uint64_t ticks, std::uint32_t interface);

  Format format_ = Format::kUnknown;
  ByteOrder order_ = ByteOrder::kLittle;
  std::uint32_t classic_link_type_ = 0;
  std::vector<TimeUnit> known_units_;
  std::vector<SubsecondUnit> units_;  // the last one applies to the current records
  std::vector<Interface> interfaces_;
  std::optional<MisstatedResolution> misstated_;
  bool has_counter_stamps_ = false;
  std::uint64_t card_clock_ = 0;  // clock [us] of the last record of an Intel 5300 log
};

}  // namespace rayloc::pcap
