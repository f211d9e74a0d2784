// Layout of the UDP payload, little-endian (WIRE_FORMATS 1.1):
//
//   offset size  field
//    0     6     transmitter address, network order
//    6     2     sequence, the receiver's frame counter
//    8     2     core 0..3
//   10     2     spatial stream 0..3
//   12     2     first tone of this datagram
//   14     2     last tone, inclusive
//   16     2     tones in total for this core and stream: 64, 128, 256, 512, 1024, 2048
//   18     2     802.11 sequence control
//   20     4     ratespec
//   24     6     receive time, 48 bits
//   30     2     sequence control again
//   32     4     radio time [us]
//   36     6     transmit time, 48 bits
//   42     2     transmit sequence
//   44     4     power per core [dBm], signed, core 3 first
//   48     4     PhyRxStatus
//   52     2     chanspec
//   54     4n    CSI words (csi_words.h, kFloat12), n = last - first + 1
#include "capture/decode/axcsi_decoder.h"

#include <algorithm>

#include "capture/decode/chanspec.h"
#include "capture/decode/decoder_row.h"
#include "capture/decode/payload_digest.h"
#include "capture/transport/byte_reader.h"

namespace rayloc {
namespace {

constexpr unsigned kEncodingLegacy = 0;
constexpr unsigned kEncodingHt = 1;

AxcsiHeader read_fields(const ByteReader& reader) {
  AxcsiHeader header;
  for (std::size_t i = 0; i < header.transmitter.octets.size(); ++i) {
    header.transmitter.octets[i] = reader.u8(i);
  }
  header.sequence = reader.u16(6);
  header.rx_chain = reader.u16(8);
  header.stream = reader.u16(10);
  header.first_tone = reader.u16(12);
  header.last_tone = reader.u16(14);
  header.total_tones = reader.u16(16);
  header.sequence_control = reader.u16(18);
  header.ratespec = reader.u32(20);
  header.receive_ticks = reader.u48(24);
  header.receive_sequence = reader.u16(30);
  header.receive_time_us = reader.u32(32);
  header.transmit_ticks = reader.u48(36);
  header.transmit_sequence = reader.u16(42);
  for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
    header.power_dbm[rx_chain] = reader.i8(47 - rx_chain);
  }
  header.phy_status = reader.u32(48);
  header.chanspec = reader.u16(52);
  return header;
}

bool length_fits(const AxcsiHeader& header, std::size_t size) {
  return header.first_tone <= header.last_tone &&
         size == kAxcsiHeaderBytes +
                     kBytesPerWord * (header.last_tone - header.first_tone + std::size_t{1});
}

// Bandwidth of the channel, by the size of the transform: 0 if no such transform exists.
int channel_bandwidth_mhz(unsigned encoding, unsigned total_tones) {
  const unsigned tones_of_20_mhz = encoding == kAxcsiEncodingHe ? 256 : 64;
  for (const unsigned parts : {1U, 2U, 4U, 8U}) {
    if (total_tones == parts * tones_of_20_mhz) {
      return static_cast<int>(20 * parts);
    }
  }
  return 0;
}

PhyFormat phy_of(unsigned encoding) {
  switch (encoding) {
    case kEncodingLegacy:
      return PhyFormat::kLegacy;
    case kEncodingHt:
      return PhyFormat::kHt;
    case kAxcsiEncodingHe:
      return PhyFormat::kHe;
    default:
      return PhyFormat::kVht;
  }
}

}  // namespace

unsigned AxcsiHeader::streams() const {
  switch (encoding()) {
    case kEncodingLegacy:
      return 1;
    case kEncodingHt:
      return std::min((ratespec & 0x1fU) / 8U, 3U) + 1U;  // MCS 0..31, eight a stream
    default:
      return std::max(1U, (ratespec >> 4U) & 0xfU);
  }
}

unsigned AxcsiHeader::mcs() const {
  return encoding() <= kEncodingHt ? ratespec & 0xffU : ratespec & 0xfU;
}

tl::expected<AxcsiHeader, RejectReason> read_axcsi_header(std::span<const std::byte> payload) {
  if (payload.size() < kAxcsiHeaderBytes) {
    return tl::make_unexpected(RejectReason::kTooShort);
  }
  const AxcsiHeader header = read_fields(ByteReader(payload));
  if (!length_fits(header, payload.size())) {
    return tl::make_unexpected(RejectReason::kLengthMismatch);
  }
  if (header.encoding() > kAxcsiEncodingHe) {
    return tl::make_unexpected(RejectReason::kEncodingRange);
  }
  if (header.rx_chain >= kMaxRxChains) {
    return tl::make_unexpected(RejectReason::kRxChainRange);
  }
  if (header.stream >= kMaxStreams) {
    return tl::make_unexpected(RejectReason::kStreamRange);
  }
  if (header.last_tone >= header.total_tones || header.first_tone % kToneBlock != 0 ||
      (header.last_tone + 1) % kToneBlock != 0 ||
      channel_bandwidth_mhz(header.encoding(), header.total_tones) == 0) {
    return tl::make_unexpected(RejectReason::kToneRange);
  }
  if (header.sequence_control != header.receive_sequence) {
    return tl::make_unexpected(RejectReason::kHeaderMismatch);
  }
  return header;
}

DecodeResult AxcsiDecoder::decode(std::span<const std::byte> payload) const {
  const auto header = read_axcsi_header(payload);
  RAYLOC_TRY(header);
  CsiFragment fragment;
  fragment.format = format();
  fragment.transmitter = header->transmitter;
  fragment.has_sequence = true;
  fragment.sequence = header->sequence;
  fragment.sequence_control = header->sequence_control;
  fragment.rx_chain = static_cast<std::uint8_t>(header->rx_chain);
  fragment.stream = static_cast<std::uint8_t>(header->stream);
  fragment.first_tone = header->first_tone;
  fragment.tones = static_cast<std::uint16_t>(header->last_tone - header->first_tone + 1);
  fragment.total_tones = header->total_tones;
  fragment.phy = phy_of(header->encoding());
  fragment.channel_bandwidth_mhz = channel_bandwidth_mhz(header->encoding(), header->total_tones);
  fragment.transmitted_streams =
      static_cast<int>(header->streams() * (header->space_time_coded() ? 2U : 1U));
  for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
    if (header->power_dbm[rx_chain] < 0) {  // 0: the chain was off
      fragment.power_dbm[rx_chain] = header->power_dbm[rx_chain];
    }
  }
  fragment.layout = CsiWords::kFloat12;
  fragment.words = payload.subspan(kAxcsiHeaderBytes);
  fragment.digest = payload_digest(fragment.words);
  fragment.channel = channel_of_chanspec(header->chanspec);
  return fragment;
}

bool resembles_axcsi(std::span<const std::byte> payload) {
  if (payload.size() < kAxcsiHeaderBytes) {
    return false;
  }
  const AxcsiHeader header = read_fields(ByteReader(payload));
  if (length_fits(header, payload.size())) {
    return true;
  }
  return header.rx_chain < kMaxRxChains && header.stream < kMaxStreams &&
         header.encoding() <= kAxcsiEncodingHe &&
         channel_bandwidth_mhz(header.encoding(), header.total_tones) != 0 &&
         header.sequence_control == header.receive_sequence;
}

const DecoderRow kAxcsiRow{.name = "axcsi-v4",
                           .resembles = resembles_axcsi,
                           .make = []() -> AnyDecoder { return std::make_unique<AxcsiDecoder>(); }};

}  // namespace rayloc
