// CaptureSimulator: what an access point of a room would record of a device, or of a fixed
// transmitter past a person: the AX-CSI datagrams, made by our own tracer.
//
// For tests, planning and studies. What is located in such a capture is located with the very model
// that made it: it says nothing about the accuracy in a room.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "capture/decode/axcsi_decoder.h"
#include "daemon/simulate/channel_draw.h"
#include "daemon/simulate/impairments.h"
#include "daemon/simulate/radio.h"
#include "daemon/simulate/transmissions.h"
#include "engine/base/expected.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"
#include "engine/trace/array_tracer.h"
#include "engine/trace/diffuse/diffuse_field.h"
#include "engine/trace/scattering/scattering.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

// Somebody without a device, and the transmitter that stays where it is.
struct SimulatedPerson {
  Vec3d transmitter;  // [m]
  TargetBody body;
};

struct CaptureOptions {
  MacAddress transmitter;
  AntennaPattern pattern = AntennaPattern::kHalfWaveDipole;  // of the device
  Polarization polarization = Polarization::kVertical;
  int bandwidth_mhz = 40;                 // of the channel
  std::optional<SimulatedPerson> person;  // then spots are the person's, not the device's
  // With `diffuse` the phases of rough surfaces are those of `seed`.
  TraceOptions trace;
  // Channels are ChannelDraw's, traced as the likelihood does it, not by `trace`. REQUIRES: no
  // `person`.
  bool model_error = false;
  Impairments impairments;
  // Of each chain of the access point, what a power cycle multiplied it by; empty: none has been.
  std::vector<std::complex<double>> chain_changes = {};
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
  // The body of CaptureOptions::person can be traced (TargetTracer::create).
  CaptureSimulator(const RoomModel& room, std::size_t access_point, const CaptureOptions& options);
  // For a device that hops: a room for each channel (Transmission::channel), the same but for its
  // frequency and what materials are there. The radio is one: chains, coupling, counter.
  // REQUIRES: as above of each; there is one.
  CaptureSimulator(std::span<const RoomModel> rooms,
                   std::size_t access_point,
                   const CaptureOptions& options);

  // Spots in order of time. An Error when a person would stand on a device.
  Expected<SpotCapture> hear(const SimulatedSpot& spot);

  // As on that channel, by tone from its centre.
  const ChainGains& chains(std::size_t channel = 0) const {
    return channels_.at(channel).radio.chains();
  }

 private:
  struct Diffuse {
    DiffuseField field;
    std::vector<DiffuseField::End> antennas;
  };
  // What is traced and received on one radio channel.
  struct OnChannel {
    OnChannel(const RoomModel& room,
              std::size_t access_point,
              const CaptureOptions& options,
              std::size_t number);

    ArrayTracer tracer;
    std::vector<TargetLink> past_person;  // of each antenna; empty without a person
    std::optional<Diffuse> diffuse;
    std::optional<ChannelDraw> draw;
    SimulatedRadio radio;
    std::uint16_t chanspec = 0;
  };
  static std::optional<Diffuse> diffuse_of(const RoomModel& room,
                                           const AntennaArray& array,
                                           const CaptureOptions& options);
  // [antenna][tone] on the radio's grid; adds to `count` the paths that it is made of.
  Expected<std::vector<std::complex<double>>> channel_at(OnChannel& on,
                                                         const SimulatedSpot& spot,
                                                         std::size_t& count) const;

  CaptureOptions options_;
  std::deque<OnChannel> channels_;
  std::vector<std::uint8_t> cores_;
  AxcsiHeader header_;  // of the last frame
  RandomStream losses_;
};

}  // namespace rayloc
