#include "daemon/lab/simulate/simulate_recordings.h"

#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "capture/record/pcap_recorder.h"
#include "daemon/lab/simulate/capture_simulator.h"
#include "daemon/lab/simulate/simulation_setup.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc {
namespace {

Expected<PcapRecorder> create_recording(const std::string& file, bool force) {
  if (force) {
    std::error_code ignored;  // create() reports an existing file
    std::filesystem::remove(file, ignored);
  }
  return PcapRecorder::create(file);
}

// `progress`: receives the share of this recording that is done, 0 to 1.
template <typename Progress>
Expected<CaptureReport> record(const SimulationSetup& setup,
                               const SimulatedOutput& output,
                               bool force,
                               const Progress& progress) {
  std::size_t index = 0;
  while (setup.rooms.front().access_points[index].id != output.access_point) {
    ++index;
  }
  auto recorder = create_recording(output.file, force);
  RAYLOC_TRY(recorder);
  CaptureOptions options = setup.options;
  if (setup.day) {
    options.chain_changes = setup.lived.access_points[index].chain_changes;
  }
  CaptureSimulator simulator(setup.rooms, index, options);
  CaptureReport report{output.access_point, output.file, 0, 0, {}, simulator.chains()};
  std::size_t done = 0;
  for (const SimulatedPoint& test_point : setup.test_points) {
    const auto received = simulator.capture(test_point);
    if (!received) {
      return bad_input("point of line " + std::to_string(test_point.line) + ": " +
                       received.error().message);
    }
    std::vector<Datagram> batch;
    batch.reserve(received->datagrams.size());
    for (const SimulatedDatagram& datagram : received->datagrams) {
      batch.push_back({datagram.time, {}, datagram.payload});
    }
    RAYLOC_TRY(recorder->write(batch));
    report.datagrams += batch.size();
    report.lost += received->lost;
    if (received->paths == 0) {
      report.lines_without_path.push_back(test_point.line);
    }
    progress(static_cast<double>(++done) / static_cast<double>(setup.test_points.size()));
  }
  RAYLOC_TRY(recorder->sync());
  return report;
}

void note_unmoved_things(const SimulationSetup& setup, const Observer& observer) {
  if (setup.day && static_cast<double>(setup.lived.moved.size()) < setup.day->moved_things) {
    observer.note(
        fmt::format("{} of {:.0f} things were moved: the room has no more that are movable and "
                    "have a free place",
                    setup.lived.moved.size(),
                    setup.day->moved_things));
  }
}

void note_unreached_points(const CaptureReport& report, const Observer& observer) {
  if (!report.lines_without_path.empty()) {
    observer.note(
        fmt::format("no path reaches {} from {} points, the first of line {}: only noise is "
                    "recorded there",
                    report.access_point,
                    report.lines_without_path.size(),
                    report.lines_without_path.front()));
  }
}

}  // namespace

Expected<SimulatedTruth> simulate_recordings(const Site& site,
                                             const SimulationOptions& options,
                                             const SimulationObserver& observer) {
  auto setup = read_simulation_setup(site, options, observer);
  RAYLOC_TRY(setup);
  if (!options.truth.empty() && !options.force && std::filesystem::exists(options.truth)) {
    return make_error(ErrorKind::kUnavailable,
                      options.truth + ": exists already; choose another name, or give --force");
  }
  note_unmoved_things(*setup, observer);
  std::vector<CaptureReport> captures;
  for (const SimulatedOutput& output : options.outputs) {
    auto capture = record(*setup, output, options.force, [&](double share) {
      observer.progress((static_cast<double>(captures.size()) + share) /
                            static_cast<double>(options.outputs.size()),
                        output.access_point);
    });
    RAYLOC_TRY(capture);
    note_unreached_points(*capture, observer);
    captures.push_back(*std::move(capture));
  }
  SimulatedTruth truth{std::move(setup->options),
                       std::move(setup->test_points),
                       setup->is_walk,
                       std::move(captures),
                       options.handling,
                       std::move(setup->day),
                       std::move(setup->lived),
                       std::move(setup->channels)};
  if (!options.truth.empty()) {
    RAYLOC_TRY(write_file(options.truth, truth_csv(truth)));
  }
  return truth;
}

}  // namespace rayloc
