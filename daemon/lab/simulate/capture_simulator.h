// CaptureSimulator: simulates an access point's recording of a device, or of a fixed transmitter
// past a person: the AX-CSI datagrams, made by our own tracer.
//
// For tests, planning and studies. Such a capture is located with the same model that made it, so
// it gives no information about the accuracy in a real room.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "capture/decode/axcsi_decoder.h"
#include "daemon/lab/simulate/channel_draw.h"
#include "daemon/lab/simulate/impairments.h"
#include "daemon/lab/simulate/radio.h"
#include "daemon/lab/simulate/transmissions.h"
#include "engine/base/expected.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"
#include "engine/trace/array_tracer.h"
#include "engine/trace/diffuse/diffuse_field.h"
#include "engine/trace/scattering/scattering.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

// A person without a device, and the stationary transmitter.
struct SimulatedPerson {
  Vec3d transmitter;  // [m]
  TargetBody body;
};

struct CaptureOptions {
  MacAddress transmitter;
  AntennaPattern pattern = AntennaPattern::kHalfWaveDipole;  // for the device
  Polarization polarization = Polarization::kVertical;
  int bandwidth_mhz = 40;                 // width of the channel
  std::optional<SimulatedPerson> person;  // if set, test points are the person's, not the device's
  // With `diffuse`, the phases of rough surfaces are drawn from `seed`.
  TraceOptions trace;
  // Channels are ChannelDraw's, traced as in the
  // likelihood, not with `trace`. REQUIRES: no `person`.
  bool model_error = false;
  Impairments impairments;
  // By chain of the access point, the factor of a power cycle; empty: no power cycle.
  std::vector<std::complex<double>> chain_changes = {};
  std::uint64_t seed = 0;
};

struct SimulatedDatagram {
  Timestamp time;
  std::vector<std::byte> payload;
};

struct PointCapture {
  std::vector<SimulatedDatagram> datagrams;  // in order of time
  std::size_t paths = 0;                     // to all antennas; 0: only noise is received
  std::size_t lost = 0;                      // datagrams that do not arrive
};

class CaptureSimulator {
 public:
  // REQUIRES: access_point < room.access_points.size(), a bandwidth of tone_plan.h. The body of
  // CaptureOptions::person can be traced (TargetTracer::create).
  CaptureSimulator(const RoomModel& room, std::size_t access_point, const CaptureOptions& options);
  // For a device that hops: one room per channel (Transmission::channel), identical except for its
  // frequency and the material properties there. All channels use one radio: chains, coupling,
  // counter. REQUIRES: as above for each room; at least one room.
  CaptureSimulator(std::span<const RoomModel> rooms,
                   std::size_t access_point,
                   const CaptureOptions& options);

  // Test points in order of time. Returns an Error if the body of a person would contain a device.
  Expected<PointCapture> capture(const SimulatedPoint& test_point);

  // The gains on that channel, by tone from its centre.
  const ChainGains& chains(std::size_t channel = 0) const {
    return channels_.at(channel).radio.chains();
  }

 private:
  struct Diffuse {
    DiffuseField field;
    std::vector<DiffuseField::End> antennas;
  };
  // Tracer and receiver state of one radio channel.
  struct OnChannel {
    OnChannel(const RoomModel& room,
              std::size_t access_point,
              const CaptureOptions& options,
              std::size_t number);

    ArrayTracer tracer;
    std::vector<TargetLink> past_person;  // by antenna; empty without a person
    std::optional<Diffuse> diffuse;
    std::optional<ChannelDraw> draw;
    SimulatedRadio radio;
    std::uint16_t chanspec = 0;
  };
  static std::optional<Diffuse> diffuse_of(const RoomModel& room,
                                           const AntennaArray& array,
                                           const CaptureOptions& options);
  // [antenna][tone] on the radio's grid; adds the number of its paths to `count`.
  Expected<std::vector<std::complex<double>>> channel_at(OnChannel& on,
                                                         const SimulatedPoint& test_point,
                                                         std::size_t& count) const;

  CaptureOptions options_;
  std::deque<OnChannel> channels_;
  std::vector<std::uint8_t> rx_chains_;
  AxcsiHeader header_;  // header of the last frame
  RandomStream losses_;
};

}  // namespace rayloc
