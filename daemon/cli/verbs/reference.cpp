// `rayloc reference`: its arguments and their use.
#include <memory>
#include <string>

#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/terminal_notes.h"
#include "daemon/cli/verbs/report/reference_report.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/reference/learn_reference.h"
#include "daemon/lab/reference/reference_inputs.h"
#include "daemon/lab/reference/reference_site.h"
#include "daemon/site/survey/time_offset.h"

namespace rayloc::cli {
namespace {

struct ReferenceArguments {
  ReferenceOptions reference;
  std::string out;
  bool quiet = false;
};

Expected<void> run_reference(const ReferenceArguments& arguments) {
  ReferenceOptions options = arguments.reference;
  options.out = arguments.out;
  const Observer observer = terminal_notes(arguments.quiet);
  const auto inputs = read_reference_inputs(options, observer);
  RAYLOC_TRY(inputs);
  const auto learned = learn_reference(*inputs, observer);
  RAYLOC_TRY(learned);
  RAYLOC_TRY(write_reference_site(inputs->site, *learned, options.out, options.force));
  if (!arguments.quiet) {
    print_reference(*inputs, *learned);
  }
  return {};
}

RunVerb declare_reference(OptionParser& app) {
  const auto options = std::make_shared<ReferenceArguments>();
  ReferenceOptions& reference = options->reference;
  app.add_option("site", reference.site, "calibrated site: directory with site.toml")->required();
  app.add_option("--capture",
                 reference.captures,
                 "recordings of the empty room: [AP=]FILE, with a fixed transmitter")
      ->required();
  app.add_option("--people", reference.people, "recordings of a person at known places: [AP=]FILE");
  app.add_option(
      "--people-empty",
      reference.people_empty,
      "recordings of the empty room of the day of --people, where that is another day: "
      "[AP=]FILE; chain phases may have changed since, and chairs moved. Without it, people "
      "recorded with other chain phases are refused");
  app.add_option("--points", reference.points, "where and when: csv t_start,t_end,x,y,z");
  app.add_option("--time-offset", reference.time_offset, kTimeOffsetHelp);
  app.add_option("--out", options->out, "folder to create: the site with its reference")
      ->required();
  app.add_flag("--occupied",
               reference.occupied,
               "a person walks about in the recordings of the empty room: the channel common to "
               "half of the frames is that of the room");
  app.add_flag("--force", reference.force, "write into a folder that is not empty");
  app.add_flag("--quiet", options->quiet, "no words on stderr");
  return [options] { return run_reference(*options); };
}

}  // namespace

extern const Verb kReference;
const Verb kReference = {
    "reference",
    "Learn the empty room, so that people without a device can be located",
    "rayloc reference office-calibrated --capture ap1=empty.pcap --out office-people\n"
    "  rayloc reference office-calibrated --capture ap1=empty.pcap0 ap1=empty.pcap1 --out "
    "office-people\n"
    "  rayloc reference office-calibrated --capture ap1=empty.pcap --people ap1=person.pcap "
    "--points places.csv --out office-people\n"
    "  rayloc reference office-calibrated --capture ap1=today.pcap --people ap1=person.pcap "
    "--people-empty ap1=empty.pcap --points places.csv --out office-today\n"
    "  rayloc reference office-calibrated --capture ap1=monday.pcap --occupied --out office-people",
    declare_reference};

}  // namespace rayloc::cli
