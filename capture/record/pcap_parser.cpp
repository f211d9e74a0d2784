#include "capture/record/pcap_parser.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

namespace rayloc::pcap {
namespace {

using Step = PcapParser::Step;
using Status = PcapParser::Status;

// [PCAP] 4
constexpr std::uint32_t kMagicMicroseconds = 0xa1b2c3d4;
constexpr std::uint32_t kMagicNanoseconds = 0xa1b23c4d;
constexpr std::uint32_t kMagicKuznetzov = 0xa1b2cd34;  // a patched libpcap with longer records
constexpr std::size_t kClassicHeaderBytes = 24;
constexpr std::size_t kClassicRecordBytes = 16;
// The higher bits are the length of the frame check sequence.
constexpr std::uint32_t kLinkTypeMask = 0x0000ffff;
// libpcap's MAXIMUM_SNAPLEN: a longer record is damaged.
constexpr std::uint32_t kMaxPacketBytes = 262144;

// [PCAPNG] 4
constexpr std::uint32_t kByteOrderMagic = 0x1a2b3c4d;
constexpr std::uint32_t kSectionHeaderBlock = 0x0a0d0d0a;  // the same in both byte orders
constexpr std::uint32_t kInterfaceBlock = 1;
constexpr std::uint32_t kOldPacketBlock = 2;
constexpr std::uint32_t kSimplePacketBlock = 3;
constexpr std::uint32_t kEnhancedPacketBlock = 6;
constexpr std::size_t kBlockOverhead = 12;  // type, length, length again
constexpr std::size_t kSectionHeaderBytes = 28;
constexpr std::size_t kMaxBlockBytes = std::size_t{16} << 20;
constexpr std::uint16_t kOptionEnd = 0;
constexpr std::uint16_t kOptionTimeResolution = 9;
constexpr std::uint16_t kOptionTimeOffset = 14;
// Each interface takes memory, and a real file has only a few.
constexpr std::size_t kMaxInterfaces = 4096;

// The log of the Intel 5300's CSI tool (WIRE_FORMATS 1.9).
constexpr std::uint8_t kIntelCsi = 0xbb;
constexpr std::uint8_t kIntelFrame = 0xc1;
// All notifications of the card's driver.
constexpr std::array<std::uint8_t, 8> kIntelCodes = {
    kIntelCsi, kIntelFrame, 0x1c, 0xc0, 0xc3, 0xc5, 0xd0, 0xd1};
constexpr std::size_t kIntelLengthBytes = 2;     // not counted in the length itself
constexpr std::size_t kIntelHeaderBytes = 21;    // length of a record with CSI, from its code on
constexpr std::size_t kIntelExtendedBytes = 18;  // additional bytes of extended records
constexpr std::size_t kIntelSignatureBytes = kIntelLengthBytes + 11;  // up to the chain counts

__extension__ using Int128 = __int128;
constexpr std::int64_t kNanoseconds = 1'000'000'000;

Step need_more() { return {}; }
Step other(std::size_t size) {
  return {.status = Status::kOther, .size = size, .packet = {}, .error = {}};
}
Step header(std::size_t size) {
  Step step = other(size);
  step.begins_capture = true;
  return step;
}
Step failure(std::string error) {
  return {.status = Status::kError, .size = 0, .packet = {}, .error = std::move(error)};
}

// Converts ticks of if_tsresol `resolution` to ns. [PCAPNG] 4.2: the high bit means power of 2.
Int128 to_nanoseconds(std::uint64_t ticks, std::uint8_t resolution) {
  const unsigned exponent = resolution & 0x7fU;
  if ((resolution & 0x80U) != 0) {
    return (static_cast<Int128>(ticks) * kNanoseconds) >> exponent;
  }
  auto value = static_cast<Int128>(ticks);
  for (unsigned i = exponent; i < 9; ++i) {
    value *= 10;
  }
  for (unsigned i = 9; i < exponent && value != 0; ++i) {
    value /= 10;
  }
  return value;
}

// Empty if it is outside the years 1824 to 2116: any two times in that range have a distance that a
// Duration can represent.
std::optional<Timestamp> timestamp(std::uint64_t ticks,
                                   std::uint8_t resolution,
                                   std::int64_t offset_s) {
  const Int128 ns =
      to_nanoseconds(ticks, resolution) + static_cast<Int128>(offset_s) * kNanoseconds;
  constexpr Int128 kFarthest = std::numeric_limits<std::int64_t>::max() / 2;
  if (ns > kFarthest || ns < -kFarthest) {
    return std::nullopt;
  }
  return Timestamp(Duration(static_cast<std::int64_t>(ns)));
}

// No recording of CSI is older.
bool is_plausible(const std::optional<Timestamp>& time) {
  using std::chrono::year;
  constexpr Timestamp kFirst = std::chrono::sys_days(year(2005) / 1 / 1);
  constexpr Timestamp kLast = std::chrono::sys_days(year(2100) / 1 / 1);
  return time && *time >= kFirst && *time < kLast;
}

std::string not_a_capture(Bytes data) {
  std::string begins;
  for (std::size_t i = 0; i < std::min<std::size_t>(4, data.size()); ++i) {
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), " %02x", load8(data, i));
    begins += text.data();
  }
  return "not a pcap, pcapng or gzip file (it begins with" + begins +
         "); write one with tcpdump -w or rayloc record";
}

bool begins_intel_log(Bytes data) {
  const std::size_t length = load16(data, 0);
  const std::uint8_t code = load8(data, kIntelLengthBytes);
  const auto is_count = [](std::uint8_t chains) { return chains >= 1 && chains <= 3; };
  // A copy of a frame begins with the fields that every 802.11 frame has.
  return (code == kIntelFrame && length > kIntelSignatureBytes) ||
         (code == kIntelCsi && length >= kIntelHeaderBytes && is_count(load8(data, 11)) &&
          is_count(load8(data, 12)));
}

}  // namespace

Step PcapParser::next(Bytes data) {
  switch (format_) {
    case Format::kUnknown:
      return file_header(data);
    case Format::kClassic:
      return classic_record(data);
    case Format::kPcapng:
      return block(data);
    case Format::kIntel5300:
      return intel_record(data);
  }
  return failure("unknown format");
}

Step PcapParser::file_header(Bytes data) {
  if (data.size() < 4) {
    return need_more();
  }
  if (load32(data, 0) == kSectionHeaderBlock) {
    return section_header(data);
  }
  for (const ByteOrder order : {ByteOrder::kLittle, ByteOrder::kBig}) {
    const std::uint32_t magic = load32(data, 0, order);
    if (magic == kMagicMicroseconds || magic == kMagicNanoseconds) {
      return classic_header(data, order);
    }
    if (magic == kMagicKuznetzov) {
      return failure("a pcap of the variant 'modified'; convert it: editcap -F pcap IN OUT");
    }
  }
  const std::uint8_t code = load8(data, kIntelLengthBytes);
  if (code == kIntelCsi || code == kIntelFrame) {
    if (data.size() < kIntelSignatureBytes) {
      return need_more();
    }
    if (begins_intel_log(data)) {
      format_ = Format::kIntel5300;
      return intel_record(data);
    }
  }
  return failure(not_a_capture(data));
}

// The header of a capture that was appended to another one; empty if `data` begins with no such
// header. More than the magic number is compared: a record may begin with its value.
std::optional<Step> PcapParser::joined_header(Bytes data) {
  constexpr std::size_t kByteOrderOffset = 8;
  const std::uint32_t begin = load32(data, 0);
  if (begin == kSectionHeaderBlock) {
    if (data.size() < kByteOrderOffset + 4) {
      return need_more();
    }
    const bool little = load32(data, kByteOrderOffset, ByteOrder::kLittle) == kByteOrderMagic;
    const bool big = load32(data, kByteOrderOffset, ByteOrder::kBig) == kByteOrderMagic;
    return little || big ? std::optional(section_header(data)) : std::nullopt;
  }
  for (const ByteOrder order : {ByteOrder::kLittle, ByteOrder::kBig}) {
    const std::uint32_t magic = load32(data, 0, order);
    if (magic != kMagicMicroseconds && magic != kMagicNanoseconds) {
      continue;
    }
    if (data.size() < kClassicHeaderBytes) {
      return need_more();
    }
    if (load16(data, 4, order) == 2 && load16(data, 6, order) == 4) {
      return classic_header(data, order);
    }
  }
  return std::nullopt;
}

Step PcapParser::intel_record(Bytes data) {
  if (data.size() < 4) {
    return need_more();
  }
  if (auto joined = joined_header(data)) {
    return *std::move(joined);
  }
  const std::size_t length = load16(data, 0);
  const std::uint8_t code = load8(data, kIntelLengthBytes);
  if (length == 0 || std::find(kIntelCodes.begin(), kIntelCodes.end(), code) == kIntelCodes.end()) {
    return failure("a record of an Intel 5300 log claims " + std::to_string(length) +
                   " bytes and the code " + std::to_string(code) +
                   ", which is neither 187 (CSI) nor 193 (a frame); the file is damaged from here "
                   "on");
  }
  const std::size_t size = kIntelLengthBytes + length;
  if (data.size() < size) {
    return need_more();
  }
  if (code != kIntelCsi) {
    return other(size);
  }
  Step step{.status = Status::kPacket, .size = size, .packet = {}, .error = {}};
  step.packet.link_type = kLinkTypeIntel5300;
  step.packet.original_length = static_cast<std::uint32_t>(length);
  step.packet.data = data.subspan(kIntelLengthBytes, length);
  if (length >= kIntelHeaderBytes) {
    step.packet.time = intel_time(step.packet.data);
  }
  return step;
}

Timestamp PcapParser::intel_time(Bytes record) {
  constexpr std::uint64_t kTurn = std::uint64_t{1} << 32;  // [us], the overflow of the clock
  const std::size_t csi = load16(record, 17, ByteOrder::kLittle);
  if (record.size() == kIntelHeaderBytes + kIntelExtendedBytes + csi) {
    return Timestamp(std::chrono::seconds(load32(record, 21, ByteOrder::kLittle)) +
                     std::chrono::microseconds(load32(record, 25, ByteOrder::kLittle)));
  }
  const std::uint64_t low = load32(record, 1, ByteOrder::kLittle);
  std::uint64_t clock = card_clock_ / kTurn * kTurn + low;
  if (clock + kTurn / 2 < card_clock_) {
    clock += kTurn;
  } else if (clock >= kTurn && clock > card_clock_ + kTurn / 2) {  // stamped before the overflow
    clock -= kTurn;
  }
  has_counter_stamps_ = true;
  card_clock_ = clock;
  return Timestamp(std::chrono::microseconds(static_cast<std::int64_t>(clock)));
}

Step PcapParser::classic_header(Bytes data, ByteOrder order) {
  if (data.size() < kClassicHeaderBytes) {
    return need_more();
  }
  const std::uint16_t major = load16(data, 4, order);
  if (major != 2) {
    return failure("pcap version " + std::to_string(major) + "; only version 2 is known");
  }
  order_ = order;
  classic_link_type_ = load32(data, 20, order) & kLinkTypeMask;
  const std::size_t index = units_.size();
  units_.emplace_back(
      load32(data, 0, order) == kMagicNanoseconds ? TimeUnit::kNanoseconds
                                                  : TimeUnit::kMicroseconds,
      index < known_units_.size() ? std::optional(known_units_[index]) : std::nullopt);
  format_ = Format::kClassic;
  return header(kClassicHeaderBytes);
}

Step PcapParser::classic_record(Bytes data) {
  if (data.size() < kClassicRecordBytes) {
    return need_more();
  }
  if (auto joined = joined_header(data)) {
    return *std::move(joined);
  }
  const std::uint32_t captured = load32(data, 8, order_);
  if (captured > kMaxPacketBytes) {
    return failure("a record claims " + std::to_string(captured) +
                   " bytes; the file is damaged from here on");
  }
  if (data.size() - kClassicRecordBytes < captured) {
    return need_more();
  }
  const std::uint32_t seconds = load32(data, 0, order_);
  Step step{
      .status = Status::kPacket, .size = kClassicRecordBytes + captured, .packet = {}, .error = {}};
  step.packet.time = Timestamp(std::chrono::seconds(seconds) +
                               units_.back().add(seconds, load32(data, 4, order_)));
  step.packet.link_type = classic_link_type_;
  step.packet.original_length = load32(data, 12, order_);
  step.packet.data = data.subspan(kClassicRecordBytes, captured);
  return step;
}

Step PcapParser::block(Bytes data) {
  if (data.size() < 4) {
    return need_more();
  }
  if (load32(data, 0) == kSectionHeaderBlock) {
    return section_header(data);
  }
  if (auto joined = joined_header(data)) {
    return *std::move(joined);
  }
  if (data.size() < 8) {
    return need_more();
  }
  const std::size_t length = load32(data, 4, order_);
  if (length < kBlockOverhead || length % 4 != 0 || length > kMaxBlockBytes) {
    return failure("a pcapng block claims " + std::to_string(length) +
                   " bytes; the file is damaged from here on");
  }
  if (data.size() < length) {
    return need_more();
  }
  if (load32(data, length - 4, order_) != length) {
    return failure("the two lengths of a pcapng block differ; the file is damaged from here on");
  }
  const Bytes body = data.subspan(8, length - kBlockOverhead);
  Step step;
  switch (load32(data, 0, order_)) {
    case kInterfaceBlock:
      step = interface_description(body);
      break;
    case kEnhancedPacketBlock:
      step = enhanced_packet(body);
      break;
    case kOldPacketBlock:
      step = old_packet(body);
      break;
    case kSimplePacketBlock:
      step = simple_packet(body);
      break;
    default:
      step = other(0);
      break;
  }
  step.size = length;
  return step;
}

Step PcapParser::section_header(Bytes data) {
  if (data.size() < 12) {
    return need_more();
  }
  if (load32(data, 8, ByteOrder::kLittle) == kByteOrderMagic) {
    order_ = ByteOrder::kLittle;
  } else if (load32(data, 8, ByteOrder::kBig) == kByteOrderMagic) {
    order_ = ByteOrder::kBig;
  } else {
    return failure("a pcapng section without its byte order; the file is damaged");
  }
  const std::size_t length = load32(data, 4, order_);
  if (length < kSectionHeaderBytes || length % 4 != 0 || length > kMaxBlockBytes) {
    return failure("a pcapng section header claims " + std::to_string(length) +
                   " bytes; the file is damaged");
  }
  if (data.size() < length) {
    return need_more();
  }
  const std::uint16_t major = load16(data, 12, order_);
  if (major != 1) {
    return failure("pcapng version " + std::to_string(major) + "; only version 1 is known");
  }
  if (load32(data, length - 4, order_) != length) {
    return failure("the two lengths of a pcapng section header differ; the file is damaged");
  }
  format_ = Format::kPcapng;
  interfaces_.clear();
  return header(length);
}

Step PcapParser::interface_description(Bytes body) {
  if (body.size() < 8) {
    return failure("a pcapng interface description is too short");
  }
  if (interfaces_.size() == kMaxInterfaces) {
    return failure("more than " + std::to_string(kMaxInterfaces) + " interfaces in one section");
  }
  Interface interface;
  interface.link_type = load16(body, 0, order_);
  interface.snap_length = load32(body, 4, order_);
  std::size_t at = 8;
  while (body.size() - at >= 4) {
    const std::uint16_t code = load16(body, at, order_);
    const std::size_t length = load16(body, at + 2, order_);
    at += 4;
    if (code == kOptionEnd) {
      break;
    }
    if (body.size() - at < length) {
      return failure("an option of a pcapng interface description is too long");
    }
    if (code == kOptionTimeResolution && length >= 1) {
      interface.resolution = load8(body, at);
    } else if (code == kOptionTimeOffset && length >= 8) {
      interface.offset_s = static_cast<std::int64_t>(load64(body, at, order_));
    }
    at += std::min((length + 3) / 4 * 4, body.size() - at);
  }
  interfaces_.push_back(interface);
  return other(0);
}

// The time, both lengths and the data of a packet block begin at body[header - 16].
Step PcapParser::timed_packet(Bytes body, std::uint32_t interface, std::size_t header) {
  if (interface >= interfaces_.size()) {
    return failure("a packet of interface " + std::to_string(interface) +
                   ", which the section does not describe");
  }
  const std::uint32_t captured = load32(body, header - 8, order_);
  if (captured > body.size() - header) {
    return failure("a packet block claims " + std::to_string(captured) +
                   " bytes of data and is shorter");
  }
  const Interface& from = interfaces_[interface];
  const std::uint64_t ticks =
      (std::uint64_t{load32(body, header - 16, order_)} << 32) | load32(body, header - 12, order_);
  Step step{.status = Status::kPacket, .size = 0, .packet = {}, .error = {}};
  step.packet.time = block_time(ticks, interface);
  step.packet.link_type = from.link_type;
  step.packet.original_length = load32(body, header - 4, order_);
  step.packet.data = body.subspan(header, captured);
  return step;
}

// Converts by the resolution that the interface states, or by nano- or microseconds if the stamp is
// plausible in that unit only.
std::optional<Timestamp> PcapParser::block_time(std::uint64_t ticks, std::uint32_t interface) {
  const Interface& from = interfaces_[interface];
  const std::optional<Timestamp> stated = timestamp(ticks, from.resolution, from.offset_s);
  if (is_plausible(stated) || from.offset_s != 0) {
    return stated;
  }
  constexpr std::array<std::uint8_t, 2> kUsual = {9, 6};
  for (const std::uint8_t resolution : kUsual) {
    const std::optional<Timestamp> shown = timestamp(ticks, resolution, 0);
    if (is_plausible(shown)) {
      misstated_ = misstated_.value_or(MisstatedResolution{interface, from.resolution, resolution});
      ++misstated_->packets;
      return shown;
    }
  }
  return stated;
}

Step PcapParser::enhanced_packet(Bytes body) {
  constexpr std::size_t kHeader = 20;
  if (body.size() < kHeader) {
    return failure("an enhanced packet block is too short");
  }
  return timed_packet(body, load32(body, 0, order_), kHeader);
}

// Like an enhanced one, with a 16-bit interface and a count of drops in place of the interface.
Step PcapParser::old_packet(Bytes body) {
  constexpr std::size_t kHeader = 20;
  if (body.size() < kHeader) {
    return failure("a packet block is too short");
  }
  return timed_packet(body, load16(body, 0, order_), kHeader);
}

Step PcapParser::simple_packet(Bytes body) const {
  if (body.size() < 4) {
    return failure("a simple packet block is too short");
  }
  if (interfaces_.empty()) {
    return failure("a simple packet block before any interface description");
  }
  const Interface& from = interfaces_.front();
  const std::uint32_t original = load32(body, 0, order_);
  const std::uint32_t limit = from.snap_length == 0 ? original : from.snap_length;
  const std::size_t captured = std::min<std::size_t>(std::min(original, limit), body.size() - 4);
  Step step{.status = Status::kPacket, .size = 0, .packet = {}, .error = {}};
  step.packet.link_type = from.link_type;
  step.packet.original_length = original;
  step.packet.data = body.subspan(4, captured);
  return step;
}

}  // namespace rayloc::pcap
