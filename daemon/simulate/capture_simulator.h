// CaptureSimulator: what an access point of a room would record of a device: the AX-CSI datagrams,
// made by our own tracer.
//
// For tests, planning and studies. What is located in such a capture is located with the very model
// that made it: it says nothing about the accuracy in a room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "capture/axcsi_decoder.h"
#include "daemon/simulate/impairments.h"
#include "daemon/simulate/radio.h"
#include "daemon/simulate/transmissions.h"
#include "engine/channel/mac_address.h"
#include "engine/localize/room_model.h"
#include "engine/trace/array_tracer.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct CaptureOptions {
  MacAddress transmitter;
  AntennaPattern pattern = AntennaPattern::kHalfWaveDipole;  // of the device
  Polarization polarization = Polarization::kVertical;
  int bandwidth_mhz = 40;  // of the channel
  TraceOptions trace;
  Impairments impairments;
  std::uint64_t seed = 0;
};

struct SimulatedDatagram {
  Timestamp time;
  std::vector<std::byte> payload;
};

struct SpotCapture {
  std::vector<SimulatedDatagram> datagrams;  // in order of time
  std::size_t paths = 0;                     // to all antennas; 0: only noise is heard
  std::size_t lost = 0;                      // datagrams that do not arrive
};

class CaptureSimulator {
 public:
  // REQUIRES: access_point < room.access_points.size(), a bandwidth of tone_plan.h.
  CaptureSimulator(const RoomModel& room, std::size_t access_point, const CaptureOptions& options);

  // Spots in order of time.
  SpotCapture hear(const SimulatedSpot& spot);

  const ChainGains& chains() const { return radio_.chains(); }

 private:
  CaptureOptions options_;
  ArrayTracer tracer_;
  SimulatedRadio radio_;
  std::vector<std::uint8_t> cores_;
  AxcsiHeader header_;  // of the last frame
  RandomStream losses_;
};

}  // namespace rayloc
