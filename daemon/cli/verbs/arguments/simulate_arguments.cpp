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
                 "Standard deviation of the device height about height_m of the site's device, "
                 "inside the room; replaces the heights of the points; smooth along a walk [m]")
      ->check(in_range(0.0, 5.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option(
         "--tilt-deg",
         simulation.handling.tilt_deg,
         "Maximum tilt of the device: uniform up to this angle, in a random direction, drawn "
         "for each point; smooth along a walk [degrees]")
      ->check(in_range(0.0, 180.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--power-sigma-db",
                 simulation.handling.power_sigma_db,
                 "Standard deviation of the transmit power, drawn for each point; smooth along a "
                 "walk [dB]")
      ->check(in_range(0.0, 30.0))
      ->excludes(person)
      ->capture_default_str();
  app.add_option("--second-day",
                 simulation.second_day,
                 "Apply the changes of another day to the room of the same --seed: default, or a "
                 "TOML file with the keys that differ from base = \"default\" (or \"none\"). Keys "
                 "and their defaults; 0: off\n" +
                     second_day_help());
  app.add_option(
      "--truth",
      simulation.truth,
      "Write the true positions of the device, in the format of rayloc evaluate --truth");
}

void declare_sender(OptionParser& app, SimulationOptions& simulation) {
  app.add_option(
      "--transmitter", simulation.transmitter, "Address or name; default: the site's first device");
  app.add_option("--channels",
                 simulation.channels,
                 "Channels over which the device hops, one frame on each: " +
                     std::string(kChannelListMeaning) +
                     ". --frames must be at least the number of channels");
}

// Declares the tracing of the waves.
void declare_waves(OptionParser& app, SimulationOptions& simulation, ParserOption* person) {
  ParserOption* const depth =
      app.add_option("--depth",
                     simulation.trace.max_depth,
                     "Maximum number of reflections (and transmissions) of a path")
          ->check(in_range(0, 8))
          ->capture_default_str();
  ParserOption* const transmission =
      app.add_flag("--transmission", simulation.trace.transmission, "Trace waves through objects");
  ParserOption* const diffuse = app.add_flag(
      "--diffuse",
      simulation.trace.diffuse,
      "Add single diffuse scattering by rough materials (scattering_coefficient of the "
      "scene or of the site), with phases from --seed; their reflections lose that power");
  app.add_flag(
         "--model-error",
         simulation.model_error,
         "Draw the channels at each point from the model error of the site's calibration: "
         "phases and strengths of paths, diffuse power, and the residual error. The paths are "
         "those of the calibration, with its corrections")
      ->excludes(person)
      ->excludes(depth)
      ->excludes(transmission)
      ->excludes(diffuse);
}

}  // namespace

void add_simulate_options(OptionParser& app, SimulateArguments& arguments) {
  SimulationOptions& simulation = arguments.simulation;
  app.add_option("SITE", arguments.site, "Directory with site.toml; may be calibrated")->required();
  app.add_option(
         "--points",
         simulation.points,
         "Positions of the device: t_start,t_end,x,y,z; or t,x,y,z for a walk with one frame "
         "per row")
      ->required();
  app.add_option("--out", arguments.out, "Recordings to write: [AP=]FILE")->required();
  app.add_option("--impairments",
                 simulation.impairments,
                 "default, none, or a TOML file with the keys that differ from base = \"default\" "
                 "(or \"none\"). Keys and their defaults; 0: off\n" +
                     impairments_help())
      ->capture_default_str();
  app.add_option("--frames",
                 simulation.transmissions.frames,
                 "Number of frames at each point; a walk has one per row")
      ->check(in_range(1, 100'000))
      ->capture_default_str();
  app.add_option(
         "--survey-error",
         simulation.transmissions.survey_error,
         "Standard deviation of the device's position about each point, along each axis [m]")
      ->check(in_range(0.0, 10.0))
      ->capture_default_str();
  declare_sender(app, simulation);
  ParserOption* const person = app.add_flag(
      "--person",
      simulation.person,
      "The points are positions of a person without a device, with the body of [person] "
      "in site.toml; the fixed --transmitter sends");
  declare_waves(app, simulation, person);
  declare_life(app, simulation, person);
  app.add_option("--seed", simulation.transmissions.seed, "Seed of all random draws")
      ->capture_default_str();
  app.add_flag("--force", simulation.force, "Replace existing files");
  app.add_flag("--quiet", arguments.quiet, "Print no messages except errors");
}

}  // namespace rayloc::cli
