#include "daemon/pipeline/output/carried_message.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "daemon/messages/location_message.h"
#include "daemon/messages/proto_time.h"

namespace rayloc {
namespace {

std::string octets(const MacAddress& mac) { return {mac.octets.begin(), mac.octets.end()}; }

// All zero for another length: no transmitter has that address.
MacAddress mac_of(const std::string& octets) {
  MacAddress mac;
  if (octets.size() == mac.octets.size()) {
    std::copy(octets.begin(), octets.end(), mac.octets.begin());
  }
  return mac;
}

std::uint64_t nanoseconds(Duration duration) {
  return static_cast<std::uint64_t>(duration.count());
}

void set_open(const OpenBursts& open, v1::OpenBursts* message) {
  *message->mutable_at() = to_proto(open.at);
  for (const BurstStart& start : open.starts) {
    v1::BurstStart* const one = message->add_starts();
    one->set_transmitter(octets(start.transmitter));
    one->set_first_before_ns(nanoseconds(open.at - start.first));
    one->set_last_before_ns(nanoseconds(open.at - start.last));
  }
}

OpenBursts open_of(const v1::OpenBursts& message) {
  OpenBursts open{from_proto(message.at()), {}};
  open.starts.reserve(static_cast<std::size_t>(message.starts_size()));
  for (const v1::BurstStart& start : message.starts()) {
    open.starts.push_back({mac_of(start.transmitter()),
                           open.at - std::chrono::nanoseconds(start.first_before_ns()),
                           open.at - std::chrono::nanoseconds(start.last_before_ns())});
  }
  return open;
}

void set_stay(const ZoneStay& stay, v1::CarriedStay* message) {
  message->set_has_dwelled(stay.has_dwelled);
  if (stay.crossing) {
    *message->mutable_crossing() = to_proto(*stay.crossing);
  }
  if (stay.entered != Timestamp()) {
    *message->mutable_entered() = to_proto(stay.entered);
  }
  message->set_probability(stay.probability);
}

ZoneStay stay_of(const v1::CarriedStay& message) {
  ZoneStay stay;
  stay.is_inside = message.place() > 0;
  stay.has_dwelled = message.has_dwelled();
  if (message.has_crossing()) {
    stay.crossing = from_proto(message.crossing());
  }
  stay.entered = from_proto(message.entered());
  stay.probability = message.probability();
  return stay;
}

void set_zones(const ZoneStays& zones, v1::Carried* message) {
  for (const ZoneStays::Occupant& occupant : zones.occupants) {
    v1::CarriedOccupant* const one = message->add_occupants();
    *one->mutable_target() = target_message(occupant.target);
    *one->mutable_heard() = to_proto(occupant.received);
    for (std::size_t zone = 0; zone < zones.zones.size(); ++zone) {
      v1::CarriedStay* const stay = one->add_stays();
      stay->set_zone(zones.zones[zone]);
      set_stay(occupant.stays[zone], stay);
    }
  }
  for (std::size_t zone = 0; zone < zones.zones.size(); ++zone) {
    std::uint32_t place = 0;
    for (const std::size_t occupant : zones.inside[zone]) {
      message->mutable_occupants(static_cast<int>(occupant))
          ->mutable_stays(static_cast<int>(zone))
          ->set_place(++place);
    }
  }
}

// Every occupant lists the same zones, and the occupants inside a zone have the places 1, 2, ...
Expected<ZoneStays> zones_of(const v1::Carried& message) {
  ZoneStays zones;
  for (const v1::CarriedOccupant& occupant : message.occupants()) {
    ZoneStays::Occupant& one = zones.occupants.emplace_back();
    one.target = target_of(occupant.target());
    one.received = from_proto(occupant.heard());
    std::vector<std::string> names;
    for (const v1::CarriedStay& stay : occupant.stays()) {
      names.push_back(stay.zone());
      one.stays.push_back(stay_of(stay));
    }
    if (zones.occupants.size() > 1 && names != zones.zones) {
      return bad_input("its targets are of different zones");
    }
    zones.zones = std::move(names);
  }
  for (std::size_t zone = 0; zone < zones.zones.size(); ++zone) {
    std::vector<std::pair<std::uint32_t, std::size_t>> inside;
    for (std::size_t i = 0; i < zones.occupants.size(); ++i) {
      const auto& stays = message.occupants(static_cast<int>(i)).stays();
      if (const std::uint32_t place = stays[static_cast<int>(zone)].place(); place > 0) {
        inside.emplace_back(place, i);
      }
    }
    std::sort(inside.begin(), inside.end());
    std::vector<std::size_t>& order = zones.inside.emplace_back();
    for (const auto& [place, occupant] : inside) {
      order.push_back(occupant);
    }
  }
  return zones;
}

void set_chains(const ChainState& state, v1::CarriedChains* message) {
  message->set_access_point(static_cast<std::uint32_t>(state.access_point));
  message->set_is_learned(state.knowledge == ChainKnowledge::kLearned);
  for (const std::complex<double>& factor : state.factors.factor) {
    message->add_factors(factor.real());
    message->add_factors(factor.imag());
  }
  message->mutable_phase_sigma()->Add(state.factors.sigma.begin(), state.factors.sigma.end());
  message->mutable_level_sigma()->Add(state.factors.log_gain_sigma.begin(),
                                      state.factors.log_gain_sigma.end());
  *message->mutable_since() = to_proto(state.since);
  message->set_bursts(state.bursts);
  message->set_bursts_needed(state.bursts_needed);
  message->set_evidence(state.evidence);
  message->set_evidence_phase_sigma(state.phase_sigma);
}

Expected<ChainState> chains_of(const v1::CarriedChains& message) {
  const int chains = message.phase_sigma_size();
  if (message.factors_size() != 2 * chains || message.level_sigma_size() != chains) {
    return bad_input("factors and sigmas are of different numbers of chains");
  }
  ChainState state;
  state.access_point = message.access_point();
  state.knowledge = message.is_learned() ? ChainKnowledge::kLearned : ChainKnowledge::kLearning;
  for (int m = 0; m < chains; ++m) {
    state.factors.factor.emplace_back(message.factors(2 * m), message.factors(2 * m + 1));
  }
  state.factors.sigma.assign(message.phase_sigma().begin(), message.phase_sigma().end());
  state.factors.log_gain_sigma.assign(message.level_sigma().begin(), message.level_sigma().end());
  state.since = from_proto(message.since());
  state.bursts = message.bursts();
  state.bursts_needed = message.bursts_needed();
  state.evidence = message.evidence();
  state.phase_sigma = message.evidence_phase_sigma();
  return state;
}

void set_verdict(const Debounce& verdict, v1::CarriedVerdict* message) {
  message->set_state(verdict.state());
  message->set_run(static_cast<std::uint32_t>(verdict.run()));
}

Debounce verdict_of(const v1::CarriedVerdict& message) {
  return Debounce(CalibrationMonitor::kSteady, message.state(), static_cast<int>(message.run()));
}

void set_monitor_state(const CalibrationMonitor::MonitorState& state,
                       v1::CarriedCalibration* message) {
  message->set_access_point(static_cast<std::uint32_t>(state.access_point));
  message->set_bursts(static_cast<std::uint32_t>(state.bursts));
  if (state.usual) {
    message->set_usual(*state.usual);
  }
  message->mutable_first()->Add(state.first.begin(), state.first.end());
  message->set_fit(state.fit);
  if (state.slow) {
    message->set_slow(*state.slow);
  }
  message->set_drifted(state.drifted);
  set_verdict(state.moved, message->mutable_moved());
  for (const double part : {state.motion.shift.x, state.motion.shift.y, state.motion.yaw}) {
    message->add_motion(part);
  }
  message->set_moved_fit(state.moved_fit);
  message->set_since_scan(static_cast<std::uint32_t>(state.since_scan));
  for (std::size_t m = 0; m < state.jump.size(); ++m) {
    set_verdict(state.jump[m], message->add_jump());
    message->add_jump_phase(state.jump_phase[m]);
  }
}

Expected<CalibrationMonitor::MonitorState> monitor_state_of(const v1::CarriedCalibration& message) {
  if (message.jump_size() != message.jump_phase_size()) {
    return bad_input("verdicts and phases are of different numbers of chains");
  }
  const auto chains = static_cast<std::size_t>(message.jump_size());
  CalibrationMonitor::MonitorState state(
      message.access_point(),
      chains,
      message.has_usual() ? std::optional<double>(message.usual()) : std::nullopt);
  state.bursts = message.bursts();
  state.first.assign(message.first().begin(), message.first().end());
  state.fit = message.fit();
  state.slow = message.has_slow() ? std::optional<double>(message.slow()) : std::nullopt;
  state.drifted = message.drifted();
  state.moved = verdict_of(message.moved());
  if (message.motion_size() == 3) {
    state.motion = {{message.motion(0), message.motion(1), 0.0}, message.motion(2)};
  }
  state.moved_fit = message.moved_fit();
  state.since_scan = static_cast<int>(message.since_scan());
  for (std::size_t m = 0; m < chains; ++m) {
    state.jump[m] = verdict_of(message.jump(static_cast<int>(m)));
    state.jump_phase[m] = message.jump_phase(static_cast<int>(m));
  }
  return state;
}

}  // namespace

v1::Carried carried_message(const Carried& carried) {
  v1::Carried message;
  *message.mutable_done() = to_proto(carried.done);
  set_open(carried.open, message.mutable_open());
  *message.mutable_heard() = to_proto(carried.received);
  message.set_last_track(carried.devices.last);
  for (const NumberedTracks::Track& track : carried.devices.tracks) {
    v1::CarriedTrack* const one = message.add_tracks();
    one->set_target(track.target);
    one->set_number(track.number);
  }
  for (const Carried::People& person : carried.people) {
    v1::CarriedPerson* const one = message.add_people();
    one->set_transmitter(octets(person.transmitter));
    one->set_number(person.number);
    if (person.moment) {
      *one->mutable_moment() = to_proto(*person.moment);
    }
  }
  set_zones(carried.zones, &message);
  for (const ChainState& state : carried.chains) {
    set_chains(state, message.add_chains());
  }
  for (const CalibrationMonitor::MonitorState& state : carried.calibration) {
    set_monitor_state(state, message.add_calibration());
  }
  for (const Carried::Watched& watched : carried.watched) {
    v1::CarriedWatch* const one = message.add_watched();
    one->set_transmitter(octets(watched.transmitter));
    *one->mutable_last() = to_proto(watched.last);
  }
  return message;
}

Expected<Carried> carried_of(const v1::Carried& message) {
  Carried carried;
  carried.done = from_proto(message.done());
  carried.open = open_of(message.open());
  carried.received = from_proto(message.heard());
  carried.devices.last = message.last_track();
  for (const v1::CarriedTrack& track : message.tracks()) {
    carried.devices.tracks.push_back({track.target(), track.number()});
  }
  for (const v1::CarriedPerson& person : message.people()) {
    Carried::People& one = carried.people.emplace_back();
    one.transmitter = mac_of(person.transmitter());
    one.number = person.number();
    if (person.has_moment()) {
      one.moment = from_proto(person.moment());
    }
  }
  auto zones = zones_of(message);
  RAYLOC_TRY(zones);
  carried.zones = *std::move(zones);
  for (const v1::CarriedChains& chains : message.chains()) {
    auto state = chains_of(chains);
    RAYLOC_TRY(state);
    carried.chains.push_back(*std::move(state));
  }
  for (const v1::CarriedCalibration& calibration : message.calibration()) {
    auto state = monitor_state_of(calibration);
    RAYLOC_TRY(state);
    carried.calibration.push_back(*std::move(state));
  }
  for (const v1::CarriedWatch& watched : message.watched()) {
    carried.watched.push_back({mac_of(watched.transmitter()), from_proto(watched.last())});
  }
  return carried;
}

}  // namespace rayloc
