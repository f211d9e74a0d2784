#include "daemon/cli/verbs/arguments/simulate_arguments.h"

#include "daemon/lab/simulate/channel_list.h"
#include "daemon/lab/simulate/impairments.h"
#include "daemon/lab/simulate/second_day.h"

namespace rayloc::cli {
namespace {

// Declares the options of a lived-in room.
void declare_life(OptionParser& app, SimulationOptions& simulation, ParserOption* person) {
  app.add_option("--height-sigma",
                 simulation.handling.height_sigma,
                 "Heights are normal, of this deviation about height_m of the site's device and "
                 "inside of the room, in place of those of the points; along a walk they change "
                 "smoothly [m]")
      ->check(in_range(0.0, 5.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--tilt-deg",
                 simulation.handling.tilt_deg,
                 "The device leans to any side by an angle that is uniform up to this, another at "
                 "each point, along a walk smoothly")
      ->check(in_range(0.0, 180.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--power-sigma-db",
                 simulation.handling.power_sigma_db,
                 "Its power is another at each point, normal, along a walk smoothly")
      ->check(in_range(0.0, 30.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--second-day",
                 simulation.second_day,
                 "Another day than that of the recordings of the same --seed without it: default, "
                 "or a TOML file with the keys that differ from base = \"default\" (or "
                 "\"none\"). The keys and their defaults; 0: off\n" +
                     second_day_help());
  app.add_option("--truth",
                 simulation.truth,
                 "Write where the device really was, as rayloc evaluate --truth reads it");
}

void declare_sender(OptionParser& app, SimulationOptions& simulation) {
  app.add_option(
      "--transmitter", simulation.transmitter, "Address or name; default: the site's first device");
  app.add_option("--channels",
                 simulation.channels,
                 "The device hops, each frame on the next channel: " +
                     std::string(kChannelListMeaning) + ". --frames are at least as many");
}

// Declares the tracing of the waves.
void declare_waves(OptionParser& app, SimulationOptions& simulation, ParserOption* person) {
  ParserOption* const depth =
      app.add_option("--depth", simulation.trace.max_depth, "Reflections (and crossings) of a path")
          ->check(in_range(0, 8))
          ->capture_default_str();
  ParserOption* const transmission = app.add_flag(
      "--transmission", simulation.trace.transmission, "Waves also go through objects");
  ParserOption* const diffuse =
      app.add_flag("--diffuse",
                   simulation.trace.diffuse,
                   "Also what rough materials scatter once (scattering_coefficient of the scene or "
                   "of the site), "
                   "with phases by --seed; they reflect that much less");
  app.add_flag("--model-error",
               simulation.model_error,
               "Channels differ from the traced ones as the calibration of the site found them to, "
               "anew at each point: phases and strengths of paths, diffuse power, and what none of "
               "these explains. Paths are those of the calibration, with its corrections")
      ->excludes(person)
      ->excludes(depth)
      ->excludes(transmission)
      ->excludes(diffuse);
}

}  // namespace

void add_simulate_options(OptionParser& app, SimulateArguments& arguments) {
  SimulationOptions& simulation = arguments.simulation;
  app.add_option("SITE", arguments.site, "Directory with site.toml; may be calibrated")->required();
  app.add_option("--points",
                 simulation.points,
                 "Positions of the device: t_start,t_end,x,y,z; or t,x,y,z, a walk with a frame at "
                 "each row")
      ->required();
  app.add_option("--out", arguments.out, "The recordings to make: [AP=]FILE")->required();
  app.add_option("--impairments",
                 simulation.impairments,
                 "default, none, or a TOML file with the keys that differ from base = \"default\" "
                 "(or \"none\"). The keys and their defaults; 0: off\n" +
                     impairments_help())
      ->capture_default_str();
  app.add_option(
         "--frames", simulation.transmissions.frames, "At each point; a walk sends one at each row")
      ->check(in_range(1, 100'000))
      ->capture_default_str();
  app.add_option("--survey-error",
                 simulation.transmissions.survey_error,
                 "Standard deviation of the device's position from each point, along each axis [m]")
      ->check(in_range(0.0, 10.0))
      ->capture_default_str();
  declare_sender(app, simulation);
  ParserOption* const person =
      app.add_flag("--person",
                   simulation.person,
                   "The points are those of a person without a device, as [person] of site.toml "
                   "states; the fixed --transmitter sends");
  declare_waves(app, simulation, person);
  declare_life(app, simulation, person);
  app.add_option("--seed", simulation.transmissions.seed, "Seed of all random draws")
      ->capture_default_str();
  app.add_flag("--force", simulation.force, "Replace files that exist");
  app.add_flag("--quiet", arguments.quiet, "No words on standard error");
}

}  // namespace rayloc::cli
