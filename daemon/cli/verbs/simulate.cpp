// `rayloc simulate`: simulates recordings of a site's access points for a device at given points.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/record/pcap_recorder.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/simulate/capture_simulator.h"
#include "daemon/lab/simulate/channel_list.h"
#include "daemon/lab/simulate/handling.h"
#include "daemon/lab/simulate/second_day.h"
#include "daemon/lab/simulate/simulate_report.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_notes.h"
#include "daemon/site/survey/csv_table.h"
#include "engine/trace/diffuse/rough_materials.h"

namespace rayloc::cli {
namespace {

struct SimulateArguments {
  std::string site;
  std::string points;
  std::vector<std::string> out;
  std::string impairments = "default";
  std::string transmitter;
  std::string channels;
  TransmissionOptions transmissions;
  Handling handling;
  std::string second_day;
  std::string truth;
  TraceOptions trace;
  bool model_error = false;
  bool person = false;
  bool force = false;
  bool quiet = false;
};

Expected<Impairments> read_impairments(const std::string& argument) {
  if (argument == "default") {
    return default_impairments();
  }
  return argument == "none" ? no_impairments() : load_impairments(argument);
}

Expected<SecondDay> read_second_day(const std::string& argument) {
  return argument == "default" ? default_second_day() : load_second_day(argument);
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

// All inputs of the simulation, read and checked.
struct Simulation {
  std::vector<RadioChannel> channels;  // hop channels of the device; empty: the site's
  std::vector<RoomModel> rooms;        // by channel; of the site's channel if empty
  bool is_walk = false;
  std::vector<SimulatedSpot> spots;
  std::vector<CaptureArgument> outputs;
  CaptureOptions options;
  std::optional<SecondDay> day;
  LivedInRoom lived;  // on the simulated day
};

Expected<void> read_spots(const SimulateArguments& arguments,
                          const Site& site,
                          Simulation& simulation) {
  const auto table = CsvTable::load(arguments.points);
  if (!table) {
    return tl::make_unexpected(table.error());
  }
  simulation.is_walk = has_instants(*table);
  const auto points = simulation.is_walk ? read_instants(*table) : read_points(*table);
  if (!points) {
    return tl::make_unexpected(points.error());
  }
  if (points->empty()) {
    return bad_input(arguments.points + ": no spots, only a header");
  }
  if (simulation.is_walk && arguments.transmissions.survey_error > 0.0) {
    return make_error(ErrorKind::kUsage,
                      "--survey-error applies to points at which the device rests; " +
                          arguments.points + " has the instants of a walk");
  }
  TransmissionOptions options = arguments.transmissions;
  options.walk = simulation.is_walk;
  options.channels = std::max<std::size_t>(simulation.channels.size(), 1);
  if (!simulation.is_walk && options.frames < options.channels) {
    return make_error(ErrorKind::kUsage,
                      "--frames " + std::to_string(options.frames) +
                          ": each point needs a frame on each of the " +
                          std::to_string(options.channels) + " channels of --channels");
  }
  options.retry_share = simulation.options.impairments.retry_share;
  auto spots = plan_transmissions(*points, options, arguments.points);
  if (!spots) {
    return tl::make_unexpected(std::move(spots.error()));
  }
  simulation.spots = *std::move(spots);
  const auto sender = find_sender(site, arguments.transmitter);
  if (!sender) {
    return tl::make_unexpected(sender.error());
  }
  if (arguments.person) {
    if (sender->role != TransmitterRole::kFixed || !sender->position) {
      return make_error(ErrorKind::kUsage,
                        "--person needs a fixed transmitter of the site; name it with "
                        "--transmitter");
    }
    simulation.options.person = SimulatedPerson{*sender->position, stated_person(site).body};
  }
  simulation.options.transmitter = sender->mac;
  simulation.options.pattern = sender->pattern;
  simulation.options.polarization = sender->polarization;
  return {};
}

// Applies displaced objects and a night's changes to the simulated room.
Expected<void> live(const SimulateArguments& arguments, Simulation& simulation) {
  if (!arguments.second_day.empty()) {
    const auto day = read_second_day(arguments.second_day);
    if (!day) {
      return tl::make_unexpected(day.error());
    }
    for (RoomModel& room : simulation.rooms) {  // the same seed moves the same objects
      auto lived = live_in(room, *day, simulation.options.seed);
      if (!lived) {
        return tl::make_unexpected(std::move(lived.error()));
      }
      simulation.lived = *std::move(lived);
      room = simulation.lived.room;
    }
    simulation.day = *day;
  }
  return handle_devices(simulation.spots,
                        simulation.is_walk,
                        arguments.handling,
                        simulation.rooms.front(),
                        simulation.options.seed,
                        arguments.points);
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

// Builds the room on each channel.
Expected<void> read_rooms(const SimulateArguments& arguments,
                          const Site& site,
                          Simulation& simulation) {
  auto room = load_room_model(site);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  if (!arguments.quiet) {
    print_scene_notes(*room->scene);
  }
  if (arguments.trace.diffuse) {
    if (auto scatters = check_scatters(*room->scene); !scatters) {
      return tl::make_unexpected(std::move(scatters.error()));
    }
  }
  for (const RadioChannel& channel : simulation.channels) {
    auto other = room_on_channel(site, *room, channel.centre_hz);
    if (!other) {
      return tl::make_unexpected(std::move(other.error()));
    }
    simulation.rooms.push_back(*std::move(other));
  }
  if (simulation.channels.empty()) {
    simulation.rooms.push_back(*std::move(room));
  }
  return {};
}

Expected<Simulation> prepare(const SimulateArguments& arguments) {
  const auto site = load_site(arguments.site);
  if (!site) {
    return tl::make_unexpected(site.error());
  }
  Simulation simulation;
  auto outputs = resolve_captures(arguments.out, access_point_ids(*site));
  if (!outputs) {
    return tl::make_unexpected(std::move(outputs.error()));
  }
  simulation.outputs = *std::move(outputs);
  const auto impairments = read_impairments(arguments.impairments);
  if (!impairments) {
    return tl::make_unexpected(impairments.error());
  }
  simulation.options.impairments = *impairments;
  simulation.options.bandwidth_mhz = site->carrier.bandwidth_mhz;
  simulation.options.trace = arguments.trace;
  simulation.options.seed = arguments.transmissions.seed;
  auto channels = read_channels(arguments.channels, *site);
  if (!channels) {
    return tl::make_unexpected(std::move(channels.error()));
  }
  simulation.channels = *std::move(channels);
  if (auto read = read_spots(arguments, *site, simulation); !read) {
    return tl::make_unexpected(std::move(read.error()));
  }
  if (auto read = read_rooms(arguments, *site, simulation); !read) {
    return tl::make_unexpected(std::move(read.error()));
  }
  if (auto lived = live(arguments, simulation); !lived) {
    return tl::make_unexpected(std::move(lived.error()));
  }
  simulation.options.model_error = arguments.model_error;
  if (arguments.model_error) {
    simulation.options.trace = simulation.rooms.front().trace;
  }
  return simulation;
}

Expected<PcapRecorder> create(const std::string& file, bool force) {
  if (force) {
    std::error_code ignored;  // create() reports an existing file
    std::filesystem::remove(file, ignored);
  }
  return PcapRecorder::create(file);
}

Expected<CaptureReport> simulate(const Simulation& simulation,
                                 const CaptureArgument& output,
                                 bool force) {
  std::size_t index = 0;
  while (simulation.rooms.front().access_points[index].id != output.access_point) {
    ++index;
  }
  auto recorder = create(output.file, force);
  if (!recorder) {
    return tl::make_unexpected(std::move(recorder.error()));
  }
  CaptureOptions options = simulation.options;
  if (simulation.day) {
    options.chain_changes = simulation.lived.access_points[index].chain_changes;
  }
  CaptureSimulator simulator(simulation.rooms, index, options);
  CaptureReport report{output.access_point, output.file, 0, 0, {}, simulator.chains()};
  for (const SimulatedSpot& spot : simulation.spots) {
    const auto received = simulator.capture(spot);
    if (!received) {
      return bad_input("point of line " + std::to_string(spot.line) + ": " +
                       received.error().message);
    }
    std::vector<Datagram> batch;
    batch.reserve(received->datagrams.size());
    for (const SimulatedDatagram& datagram : received->datagrams) {
      batch.push_back({datagram.time, {}, datagram.payload});
    }
    if (auto written = recorder->write(batch); !written) {
      return tl::make_unexpected(std::move(written.error()));
    }
    report.datagrams += batch.size();
    report.lost += received->lost;
    if (received->paths == 0) {
      report.lines_without_path.push_back(spot.line);
    }
  }
  if (auto synced = recorder->sync(); !synced) {
    return tl::make_unexpected(std::move(synced.error()));
  }
  return report;
}

void print_notes(const Simulation& simulation) {
  if (simulation.day &&
      static_cast<double>(simulation.lived.moved.size()) < simulation.day->moved_things) {
    std::fprintf(stderr,
                 "rayloc simulate: %zu of %.0f things were moved: the room has no more that are "
                 "movable and have a free place\n",
                 simulation.lived.moved.size(),
                 simulation.day->moved_things);
  }
}

void print_notes(const CaptureReport& report) {
  if (!report.lines_without_path.empty()) {
    std::fprintf(stderr,
                 "rayloc simulate: no path reaches %s from %zu points, the first of line %d: only "
                 "noise is recorded there\n",
                 report.access_point.c_str(),
                 report.lines_without_path.size(),
                 report.lines_without_path.front());
  }
}

Expected<void> run_simulate(const SimulateArguments& arguments) {
  const auto simulation = prepare(arguments);
  if (!simulation) {
    return tl::make_unexpected(simulation.error());
  }
  if (!arguments.truth.empty() && !arguments.force && std::filesystem::exists(arguments.truth)) {
    return make_error(ErrorKind::kUnavailable,
                      arguments.truth + ": exists already; choose another name, or give --force");
  }
  if (!arguments.quiet) {
    print_notes(*simulation);
  }
  std::vector<CaptureReport> captures;
  for (const CaptureArgument& output : simulation->outputs) {
    auto capture = simulate(*simulation, output, arguments.force);
    if (!capture) {
      return tl::make_unexpected(std::move(capture.error()));
    }
    if (!arguments.quiet) {
      print_notes(*capture);
    }
    captures.push_back(*std::move(capture));
  }
  SimulatedTruth truth{simulation->options, simulation->spots, captures, arguments.handling};
  truth.channels = simulation->channels;
  if (simulation->day) {
    truth.day = &*simulation->day;
    truth.lived = &simulation->lived;
  }
  if (!arguments.truth.empty()) {
    if (auto written = write_file(arguments.truth, truth_csv(truth, simulation->is_walk));
        !written) {
      return written;
    }
  }
  const std::string report = simulation_json(truth);
  std::fputs(report.c_str(), stdout);
  return {};
}

// Declares the options of a lived-in room.
void declare_life(OptionParser& app, SimulateArguments& arguments, ParserOption* person) {
  app.add_option("--height-sigma",
                 arguments.handling.height_sigma,
                 "Heights are normal, of this deviation about height_m of the site's device and "
                 "inside of the room, in place of those of the points; along a walk they change "
                 "smoothly [m]")
      ->check(in_range(0.0, 5.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--tilt-deg",
                 arguments.handling.tilt_deg,
                 "The device leans to any side by an angle that is uniform up to this, another at "
                 "each point, along a walk smoothly")
      ->check(in_range(0.0, 180.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--power-sigma-db",
                 arguments.handling.power_sigma_db,
                 "Its power is another at each point, normal, along a walk smoothly")
      ->check(in_range(0.0, 30.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--second-day",
                 arguments.second_day,
                 "Another day than that of the recordings of the same --seed without it: default, "
                 "or a TOML file with the keys that differ from base = \"default\" (or "
                 "\"none\"). The keys and their defaults; 0: off\n" +
                     second_day_help());
  app.add_option("--truth",
                 arguments.truth,
                 "Write where the device really was, as rayloc evaluate --truth reads it");
}

void declare_sender(OptionParser& app, SimulateArguments& arguments) {
  app.add_option(
      "--transmitter", arguments.transmitter, "Address or name; default: the site's first device");
  app.add_option("--channels",
                 arguments.channels,
                 "The device hops, each frame on the next channel: " +
                     std::string(kChannelListMeaning) + ". --frames are at least as many");
}

RunVerb declare_simulate(OptionParser& app) {
  const auto arguments = std::make_shared<SimulateArguments>();
  app.add_option("SITE", arguments->site, "Directory with site.toml; may be calibrated")
      ->required();
  app.add_option("--points",
                 arguments->points,
                 "Positions of the device: t_start,t_end,x,y,z; or t,x,y,z, a walk with a frame at "
                 "each row")
      ->required();
  app.add_option("--out", arguments->out, "The recordings to make: [AP=]FILE")->required();
  app.add_option("--impairments",
                 arguments->impairments,
                 "default, none, or a TOML file with the keys that differ from base = \"default\" "
                 "(or \"none\"). The keys and their defaults; 0: off\n" +
                     impairments_help())
      ->capture_default_str();
  app.add_option(
         "--frames", arguments->transmissions.frames, "At each point; a walk sends one at each row")
      ->check(in_range(1, 100'000))
      ->capture_default_str();
  app.add_option("--survey-error",
                 arguments->transmissions.survey_error,
                 "Standard deviation of the device's position from each point, along each axis [m]")
      ->check(in_range(0.0, 10.0))
      ->capture_default_str();
  declare_sender(app, *arguments);
  ParserOption* const person =
      app.add_flag("--person",
                   arguments->person,
                   "The points are those of a person without a device, as [person] of site.toml "
                   "states; the fixed --transmitter sends");
  ParserOption* const depth =
      app.add_option("--depth", arguments->trace.max_depth, "Reflections (and crossings) of a path")
          ->check(in_range(0, 8))
          ->capture_default_str();
  ParserOption* const transmission = app.add_flag(
      "--transmission", arguments->trace.transmission, "Waves also go through objects");
  ParserOption* const diffuse =
      app.add_flag("--diffuse",
                   arguments->trace.diffuse,
                   "Also what rough materials scatter once (scattering_coefficient of the scene or "
                   "of the site), "
                   "with phases by --seed; they reflect that much less");
  app.add_flag("--model-error",
               arguments->model_error,
               "Channels differ from the traced ones as the calibration of the site found them to, "
               "anew at each point: phases and strengths of paths, diffuse power, and what none of "
               "these explains. Paths are those of the calibration, with its corrections")
      ->excludes(person)
      ->excludes(depth)
      ->excludes(transmission)
      ->excludes(diffuse);
  declare_life(app, *arguments, person);
  app.add_option("--seed", arguments->transmissions.seed, "Seed of all random draws")
      ->capture_default_str();
  app.add_flag("--force", arguments->force, "Replace files that exist");
  app.add_flag("--quiet", arguments->quiet, "No words on standard error");
  return [arguments] { return run_simulate(*arguments); };
}

}  // namespace

extern const Verb kSimulate;
const Verb kSimulate = {
    "simulate",
    "Make the recordings that a site's access points would make of a device, by our own tracer",
    "rayloc simulate office --points survey.csv --out ap1=a.pcap ap2=b.pcap\n"
    "  rayloc simulate office --points people.csv --person --transmitter plug --out "
    "ap1=people.pcap\n"
    "  rayloc simulate office --points survey.csv --out a.pcap --impairments none --frames 1\n"
    "  rayloc simulate CALIBRATED --points spots.csv --out a.pcap --model-error\n"
    "  rayloc simulate CALIBRATED --points spots.csv --out hops.pcap --channels 36-64\n"
    "  rayloc simulate office --points walk.csv --out ap1=day2.pcap --second-day default "
    "--height-sigma 0.3 --tilt-deg 35 --power-sigma-db 4 --truth truth.csv\n\n"
    "For tests, planning and studies: made with the model that locates, the recordings do not "
    "state the accuracy in a real room.\n"
    "Prints the simulated parameters as JSON, with the phases and gains of the chains. A seed is a "
    "site: recordings of one seed share its chains, with --second-day those of that day.",
    declare_simulate};

}  // namespace rayloc::cli
