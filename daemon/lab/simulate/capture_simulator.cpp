#include "daemon/lab/simulate/capture_simulator.h"

#include <bit>
#include <cmath>

#include "capture/decode/axcsi_writer.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

// Between the datagrams of one frame: 7 to 10 us in recordings (WIRE_FORMATS 3.1).
constexpr Duration kDatagramInterval = std::chrono::microseconds(8);
constexpr std::uint32_t kLongGuardLdpc = 0x0040'0000;
constexpr std::uint32_t kMcs = 7;
constexpr std::uint32_t kPhyStatusVht = 0x0843;
constexpr double kHeSpacing = 78'125.0;  // [Hz]

RadioSetup setup_of(const RoomModel& room, std::size_t access_point, int bandwidth_mhz) {
  return {room.grid.spacing_hz == kHeSpacing ? PhyFormat::kHe : PhyFormat::kVht,
          bandwidth_mhz,
          room.grid.centre_hz,
          room.access_points.at(access_point).rx_chains};
}

// WIRE_FORMATS 1.2. The primary channel is the lowest. 0, which names no channel, beyond 5 GHz.
std::uint16_t chanspec_of(double centre_hz, int bandwidth_mhz) {
  constexpr unsigned kBand5GHz = 0xc000;
  constexpr unsigned kBand2GHz = 0x0000;
  constexpr double k5GHz = 5e9;
  constexpr double kEndOf5GHz = 5.9e9;
  if (centre_hz > kEndOf5GHz) {
    return 0;
  }
  const bool high = centre_hz > k5GHz;
  const auto channel =
      static_cast<unsigned>(std::lround((centre_hz - (high ? k5GHz : 2.407e9)) / 5e6));
  const unsigned width =
      0x1000U +
      0x0800U * static_cast<unsigned>(std::countr_zero(static_cast<unsigned>(bandwidth_mhz / 20)));
  return static_cast<std::uint16_t>((high ? kBand5GHz : kBand2GHz) | width | (channel & 0xffU));
}

AxcsiHeader header_of(const CaptureOptions& options, const RadioSetup& setup) {
  AxcsiHeader header;
  header.transmitter = options.transmitter;
  const auto encoding = static_cast<std::uint32_t>(setup.phy);
  const auto width = static_cast<std::uint32_t>(
      1 + std::countr_zero(static_cast<unsigned>(setup.bandwidth_mhz / 20)));
  constexpr std::uint32_t kOneStream = 1U << 4U;
  header.ratespec = encoding << 24U | kLongGuardLdpc | width << 16U | kOneStream | kMcs;
  header.phy_status = kPhyStatusVht;
  header.chanspec = chanspec_of(setup.centre_hz, setup.bandwidth_mhz);
  return header;
}

Transmitter transmitter_at(const Pose& pose, const CaptureOptions& options) {
  return Transmitter{{pose.position, pose.orientation, options.pattern, options.polarization}};
}

void change_power(double decibels, std::vector<std::complex<double>>& h) {
  if (decibels != 0.0) {
    const double factor = std::pow(10.0, decibels / 20.0);
    for (std::complex<double>& value : h) {
      value *= factor;
    }
  }
}

std::vector<TargetLink> links_past_person(const RoomModel& room,
                                          const AntennaArray& array,
                                          const CaptureOptions& options) {
  if (!options.person) {
    return {};
  }
  ScatteringOptions scattering;
  scattering.trace = options.trace;
  const auto tracer = TargetTracer::create(room.scene, options.person->body, scattering);
  RAYLOC_CHECK(tracer.has_value());
  const auto antennas = array_elements<Receiver>(array);
  return tracer->links(transmitter_at({options.person->transmitter, {}}, options), antennas);
}

std::optional<ChannelDraw> draw_of(const RoomModel& room,
                                   std::size_t access_point,
                                   const CaptureOptions& options) {
  if (!options.model_error) {
    return std::nullopt;
  }
  RAYLOC_CHECK(!options.person);
  return std::optional<ChannelDraw>(
      std::in_place, room, access_point, random_stream(options.seed, "model error", access_point));
}

}  // namespace

CaptureSimulator::OnChannel::OnChannel(const RoomModel& room,
                                       std::size_t access_point,
                                       const CaptureOptions& options,
                                       std::size_t number)
    : tracer(PathTracer(room.scene, options.trace), room.access_points.at(access_point).array),
      past_person(links_past_person(room, room.access_points[access_point].array, options)),
      diffuse(diffuse_of(room, room.access_points[access_point].array, options)),
      draw(draw_of(room, access_point, options)),
      radio(setup_of(room, access_point, options.bandwidth_mhz),
            options.impairments,
            room.access_points[access_point].gains,
            random_stream(options.seed, "radio", access_point)),
      chanspec(chanspec_of(room.grid.centre_hz, options.bandwidth_mhz)) {
  radio.turn_chains(options.chain_changes);
  if (number > 0) {
    constexpr std::size_t kMaxAccessPoints = 1024;
    radio.draw_frames_from(
        random_stream(options.seed, "hop", number * kMaxAccessPoints + access_point));
  }
}

CaptureSimulator::CaptureSimulator(const RoomModel& room,
                                   std::size_t access_point,
                                   const CaptureOptions& options)
    : CaptureSimulator(std::span(&room, 1), access_point, options) {}

CaptureSimulator::CaptureSimulator(std::span<const RoomModel> rooms,
                                   std::size_t access_point,
                                   const CaptureOptions& options)
    : options_(options),
      rx_chains_(rooms.front().access_points.at(access_point).rx_chains),
      header_(header_of(options, setup_of(rooms.front(), access_point, options.bandwidth_mhz))),
      losses_(random_stream(options.seed, "losses", access_point)) {
  for (const RoomModel& room : rooms) {
    channels_.emplace_back(room, access_point, options, channels_.size());
  }
}

std::optional<CaptureSimulator::Diffuse> CaptureSimulator::diffuse_of(
    const RoomModel& room, const AntennaArray& array, const CaptureOptions& options) {
  if (!options.trace.diffuse) {
    return std::nullopt;
  }
  Diffuse diffuse{{room.scene, options.trace, {.seed = options.seed}}, {}};
  const std::vector<Receiver> antennas = array_elements<Receiver>(array);
  diffuse.antennas.reserve(antennas.size());
  for (const Receiver& antenna : antennas) {
    diffuse.antennas.push_back(diffuse.field.lit_by(antenna));
  }
  return diffuse;
}

Expected<std::vector<std::complex<double>>> CaptureSimulator::channel_at(
    OnChannel& on, const SimulatedPoint& test_point, std::size_t& count) const {
  const Pose device{test_point.position, test_point.orientation};
  if (on.draw) {
    ChannelDraw::Channel drawn = on.draw->at(device, on.radio.grid());
    count += drawn.rays;
    return std::move(drawn.h);
  }
  const Pose sender = options_.person ? Pose{options_.person->transmitter, {}} : device;
  const Transmitter transmitter = transmitter_at(sender, options_);
  const std::vector<Paths> paths = on.tracer.trace(transmitter);
  for (const Paths& of_element : paths) {
    count += of_element.size();
  }
  auto h = array_csi(paths, on.radio.grid());
  const auto add = [&](std::size_t antenna, const Paths& added) {
    const auto row = added.cfr(on.radio.grid());
    for (std::size_t k = 0; k < row.size(); ++k) {
      h[antenna * row.size() + k] += row[k];
    }
  };
  for (std::size_t antenna = 0; antenna < on.past_person.size(); ++antenna) {
    const auto added =
        on.past_person[antenna].trace({test_point.position.x, test_point.position.y});
    RAYLOC_TRY(added);
    add(antenna, *added);
  }
  if (on.diffuse) {
    const DiffuseField::End lit = on.diffuse->field.lit_by(transmitter);
    for (std::size_t antenna = 0; antenna < on.diffuse->antennas.size(); ++antenna) {
      add(antenna, on.diffuse->field.between(lit, on.diffuse->antennas[antenna]));
    }
  }
  return h;
}

Expected<PointCapture> CaptureSimulator::capture(const SimulatedPoint& test_point) {
  PointCapture capture;
  std::vector<std::vector<std::complex<double>>> h(channels_.size());  // [channel], those in use
  std::uniform_real_distribution<double> uniform;
  for (const Transmission& sent : test_point.frames) {
    OnChannel& on = channels_.at(sent.channel);
    if (h[sent.channel].empty()) {
      auto traced = channel_at(on, test_point, capture.paths);
      RAYLOC_TRY(traced);
      h[sent.channel] = *std::move(traced);
      change_power(test_point.power_db, h[sent.channel]);
    }
    RadioFrame received = on.radio.receive(h[sent.channel], sent.error_seed);
    ++header_.sequence;
    header_.chanspec = on.chanspec;
    header_.sequence_control = sent.sequence_control;
    header_.power_dbm = received.power_dbm;
    Timestamp time = sent.time;
    for (auto& payload : write_axcsi_frame({header_, rx_chains_, std::move(received.tones)})) {
      if (uniform(losses_) < options_.impairments.loss_share) {
        ++capture.lost;
      } else {
        capture.datagrams.push_back({time, std::move(payload)});
      }
      time += kDatagramInterval;
    }
  }
  return capture;
}

}  // namespace rayloc
