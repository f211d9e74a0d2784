#include "daemon/lab/simulate/simulation_setup.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "daemon/lab/simulate/channel_list.h"
#include "daemon/lab/simulate/handling.h"
#include "daemon/lab/simulate/impairments.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/survey/csv_table.h"
#include "daemon/site/survey/points_csv.h"
#include "engine/trace/diffuse/rough_materials.h"

namespace rayloc {
namespace {

Expected<Impairments> read_impairments(const std::string& argument) {
  if (argument == "default") {
    return default_impairments();
  }
  return argument == "none" ? no_impairments() : load_impairments(argument);
}

Expected<SecondDay> read_second_day(const std::string& argument) {
  return argument == "default" ? default_second_day() : load_second_day(argument);
}

Expected<void> check_outputs(const Site& site, const std::vector<SimulatedOutput>& outputs) {
  for (const SimulatedOutput& output : outputs) {
    const bool is_known = std::any_of(site.access_points.begin(),
                                      site.access_points.end(),
                                      [&](const auto& ap) { return ap.id == output.access_point; });
    if (!is_known) {
      return make_error(ErrorKind::kUsage,
                        "the site has no access point '" + output.access_point + "'");
    }
  }
  return {};
}

// Finds a transmitter of the site by address or name, or makes one of another address with a
// device's antenna; default: the site's first device.
Expected<SiteTransmitter> find_sender(const Site& site, const std::string& wanted) {
  SiteTransmitter sender;
  sender.mac = {{0x02, 0x52, 0x4c, 0x00, 0x00, 0x01}};
  for (const SiteTransmitter& known : site.transmitters) {
    const bool is_wanted = wanted.empty() ? known.role == TransmitterRole::kDevice
                                          : known.name == wanted || to_string(known.mac) == wanted;
    if (is_wanted) {
      return known;
    }
  }
  if (!wanted.empty()) {
    const auto mac = parse_mac_address(wanted);
    if (!mac) {
      return make_error(ErrorKind::kUsage,
                        "--transmitter " + wanted +
                            ": neither the name of a transmitter of the site nor an address");
    }
    sender.mac = *mac;
  }
  return sender;
}

// Returns empty if the site's channel is the only one.
Expected<std::vector<RadioChannel>> read_channels(const std::string& argument, const Site& site) {
  if (argument.empty()) {
    return std::vector<RadioChannel>();
  }
  auto channels =
      parse_channels(argument, {site.carrier.grid.centre_hz, site.carrier.bandwidth_mhz});
  if (!channels) {
    return make_error(ErrorKind::kUsage,
                      "--channels " + argument + ": " + channels.error().message);
  }
  return channels;
}

Expected<void> read_test_points(const SimulationOptions& options, SimulationSetup& setup) {
  const auto table = CsvTable::load(options.points);
  RAYLOC_TRY(table);
  setup.is_walk = has_instants(*table);
  const auto points = setup.is_walk ? read_instants(*table) : read_points(*table);
  RAYLOC_TRY(points);
  if (points->empty()) {
    return bad_input(options.points + ": no spots, only a header");
  }
  if (setup.is_walk && options.transmissions.survey_error > 0.0) {
    return make_error(ErrorKind::kUsage,
                      "--survey-error applies to points at which the device rests; " +
                          options.points + " has the instants of a walk");
  }
  TransmissionOptions transmissions = options.transmissions;
  transmissions.walk = setup.is_walk;
  transmissions.channels = std::max<std::size_t>(setup.channels.size(), 1);
  if (!setup.is_walk && transmissions.frames < transmissions.channels) {
    return make_error(ErrorKind::kUsage,
                      "--frames " + std::to_string(transmissions.frames) +
                          ": each point needs a frame on each of the " +
                          std::to_string(transmissions.channels) + " channels of --channels");
  }
  transmissions.retry_share = setup.options.impairments.retry_share;
  auto test_points = plan_transmissions(*points, transmissions, options.points);
  RAYLOC_TRY(test_points);
  setup.test_points = *std::move(test_points);
  return {};
}

Expected<void> read_sender(const Site& site,
                           const SimulationOptions& options,
                           SimulationSetup& setup) {
  const auto sender = find_sender(site, options.transmitter);
  RAYLOC_TRY(sender);
  if (options.person) {
    if (sender->role != TransmitterRole::kFixed || !sender->position) {
      return make_error(ErrorKind::kUsage,
                        "--person needs a fixed transmitter of the site; name it with "
                        "--transmitter");
    }
    setup.options.person = SimulatedPerson{*sender->position, stated_person(site).body};
  }
  setup.options.transmitter = sender->mac;
  setup.options.pattern = sender->pattern;
  setup.options.polarization = sender->polarization;
  return {};
}

// Builds the room on each channel.
Expected<void> read_rooms(const Site& site,
                          const SimulationOptions& options,
                          const SimulationObserver& observer,
                          SimulationSetup& setup) {
  auto room = load_room_model(site);
  RAYLOC_TRY(room);
  if (observer.on_scene_note) {
    for (const SceneNote& note : room->scene->notes()) {
      observer.on_scene_note(note);
    }
  }
  if (options.trace.diffuse) {
    RAYLOC_TRY(check_scatters(*room->scene));
  }
  for (const RadioChannel& channel : setup.channels) {
    auto other = room_on_channel(site, *room, channel.centre_hz);
    RAYLOC_TRY(other);
    setup.rooms.push_back(*std::move(other));
  }
  if (setup.channels.empty()) {
    setup.rooms.push_back(*std::move(room));
  }
  return {};
}

// Applies displaced objects and a night's changes to the simulated room.
Expected<void> live(const SimulationOptions& options, SimulationSetup& setup) {
  if (!options.second_day.empty()) {
    const auto day = read_second_day(options.second_day);
    RAYLOC_TRY(day);
    for (RoomModel& room : setup.rooms) {  // the same seed moves the same objects
      auto lived = live_in(room, *day, setup.options.seed);
      RAYLOC_TRY(lived);
      setup.lived = *std::move(lived);
      room = setup.lived.room;
    }
    setup.day = *day;
  }
  return handle_devices(setup.test_points,
                        setup.is_walk,
                        options.handling,
                        setup.rooms.front(),
                        setup.options.seed,
                        options.points);
}

}  // namespace

Expected<SimulationSetup> read_simulation_setup(const Site& site,
                                                const SimulationOptions& options,
                                                const SimulationObserver& observer) {
  SimulationSetup setup;
  RAYLOC_TRY(check_outputs(site, options.outputs));
  const auto impairments = read_impairments(options.impairments);
  RAYLOC_TRY(impairments);
  setup.options.impairments = *impairments;
  setup.options.bandwidth_mhz = site.carrier.bandwidth_mhz;
  setup.options.trace = options.trace;
  setup.options.seed = options.transmissions.seed;
  auto channels = read_channels(options.channels, site);
  RAYLOC_TRY(channels);
  setup.channels = *std::move(channels);
  RAYLOC_TRY(read_test_points(options, setup));
  RAYLOC_TRY(read_sender(site, options, setup));
  RAYLOC_TRY(read_rooms(site, options, observer, setup));
  RAYLOC_TRY(live(options, setup));
  setup.options.model_error = options.model_error;
  if (options.model_error) {
    setup.options.trace = setup.rooms.front().trace;
  }
  return setup;
}

}  // namespace rayloc
