#include "daemon/lab/calibrate/unsurveyed/calibrate_unsurveyed.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/lab/calibrate/calibrate.h"
#include "daemon/lab/calibrate/calibrate_rechain.h"
#include "daemon/lab/calibrate/unsurveyed/located_places.h"
#include "daemon/lab/calibrate/unsurveyed/plan_calibration.h"
#include "daemon/lab/calibrate/unsurveyed/unsurveyed_report.h"
#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFewestPoints = 24;  // count, chosen: two of the smallest usual survey
constexpr double kMinSigma = 0.005;        // [m], no position is surer than a tape measurement

// A temporary folder of this run, removed at its end.
class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (fs::temp_directory_path() / "rayloc-unsurveyed-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) {
      path_ = name;
    }
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  WorkFolder(WorkFolder&&) = delete;
  WorkFolder& operator=(WorkFolder&&) = delete;

  std::string file(const char* name) const { return path_ / name; }
  bool is_there() const { return !path_.empty(); }

 private:
  fs::path path_;
};

Expected<LocatedPlaces> places_in(const std::string& site_folder,
                                  const std::vector<std::string>& stated) {
  const auto site = load_site(site_folder);
  RAYLOC_TRY(site);
  const auto room = load_room_model(*site);
  RAYLOC_TRY(room);
  const auto captures = resolve_captures(stated, access_point_ids(*site), PerAccessPoint::kSeveral);
  RAYLOC_TRY(captures);
  std::vector<std::string> repeated_notices;
  return located_places(*site, *room, *captures, repeated_notices);
}

bool is_one_alone(const std::vector<std::string>& captures) {
  const auto access_point = [](const std::string& capture) {
    return capture.substr(0, capture.find('='));
  };
  return std::all_of(captures.begin(), captures.end(), [&](const std::string& one) {
    return access_point(one) == access_point(captures.front());
  });
}

// Writes the reports of a site that has the walls of the plan.
Expected<void> write_reports(const std::string& folder,
                             UnsurveyedReport report,
                             const UnsurveyedObserver& observer) {
  const fs::path out = folder;
  const auto site = load_site(folder);
  RAYLOC_TRY(site);
  const auto calibration = load_calibration_file(out / "calibration.toml");
  RAYLOC_TRY(calibration);
  report.site = site->name;
  report.calibration_id = calibration->id;
  report.access_points = access_point_ids(*site);
  report.needed = kFewestPoints;
  observer.note(expectation(report));
  RAYLOC_TRY(write_file(out / "report.json", to_json(report).dump(2) + "\n"));
  return write_file(out / "report.html", to_html(report));
}

// Removes those reports of an earlier run in the same folder that this one may not replace.
Expected<void> remove_earlier_reports(const std::string& folder) {
  for (const char* name : {"chains.json", "walls.json", "walls.html"}) {
    std::error_code failed;
    const fs::path file = fs::path(folder) / name;
    fs::remove(file, failed);
    if (failed) {
      return make_error(ErrorKind::kUnavailable,
                        file.string() + ": cannot be removed: " + failed.message());
    }
  }
  return {};
}

// Writes the plan unchanged, with unknown chains.
Expected<void> write_plan(const UnsurveyedArguments& arguments,
                          const UnsurveyedObserver& observer) {
  const auto site = load_uncalibrated_site(arguments.site, arguments.out, arguments.force);
  RAYLOC_TRY(site);
  const auto room = load_room_model(*site);
  RAYLOC_TRY(room);
  RAYLOC_TRY(prepare_output(arguments.out, arguments.force));
  RAYLOC_TRY(remove_earlier_reports(arguments.out));
  RAYLOC_TRY(write_site(*site, to_toml(plan_calibration(*room)), arguments.out));
  return write_reports(arguments.out, {}, observer);
}

// Writes the site of the plan with its learned chains. The reports of these (chains.json) and of a
// fit of the walls that failed (walls.json, walls.html) are beside its own.
Expected<void> keep_plan(const std::string& learned,
                         const UnsurveyedReport& report,
                         const UnsurveyedArguments& arguments,
                         const UnsurveyedObserver& observer) {
  RAYLOC_TRY(prepare_output(arguments.out, true));
  RAYLOC_TRY(remove_earlier_reports(arguments.out));
  const fs::path out = arguments.out;
  std::error_code failed;
  fs::rename(fs::path(learned) / "report.json", fs::path(learned) / "chains.json", failed);
  for (const char* ending : {".json", ".html"}) {
    if (!failed && !report.reasons.empty()) {
      fs::rename(
          out / (std::string("report") + ending), out / (std::string("walls") + ending), failed);
    }
  }
  if (failed) {
    return make_error(ErrorKind::kUnavailable, arguments.out + ": " + failed.message());
  }
  fs::copy(learned,
           arguments.out,
           fs::copy_options::recursive | fs::copy_options::overwrite_existing,
           failed);
  if (failed) {
    return make_error(ErrorKind::kUnavailable, arguments.out + ": " + failed.message());
  }
  return write_reports(arguments.out, report, observer);
}

// Fits walls, arrays and chains to the positions of the devices.
Expected<UnsurveyedOutcome> fit_room(const std::string& learned,
                                     const std::string& points,
                                     const LocatedPlaces& places,
                                     UnsurveyedReport report,
                                     const UnsurveyedArguments& arguments,
                                     const UnsurveyedObserver& observer) {
  RAYLOC_TRY(write_file(points, to_csv(places.points)));
  CalibrateArguments calibrate;
  calibrate.site = arguments.site;
  calibrate.captures = arguments.captures;
  calibrate.points = points;
  calibrate.out = arguments.out;
  calibrate.survey_error = std::max(places.sigma, kMinSigma);
  calibrate.seed = arguments.seed;
  calibrate.force = arguments.force;
  calibrate.control = arguments.control;
  const auto calibrated = run_calibration(calibrate, observer);
  RAYLOC_TRY(calibrated);
  if (observer.on_calibration) {
    observer.on_calibration(*calibrated);
  }
  UnsurveyedOutcome outcome = UnsurveyedOutcome::kWalls;
  if (calibrated->outcome == CalibrationOutcome::kFails) {
    outcome = UnsurveyedOutcome::kChains;
    observer.note(arguments.out +
                  " has the walls of the plan, and the chains that were learned with them");
    report.reasons = calibrated->report.verdict.reasons;
    RAYLOC_TRY(keep_plan(learned, report, arguments, observer));
  } else {
    RAYLOC_TRY(remove_earlier_reports(arguments.out));
  }
  return write_file(fs::path(arguments.out) / "places.csv", to_csv(places.points)).map([&] {
    return outcome;
  });
}

}  // namespace

Expected<UnsurveyedOutcome> run_unsurveyed(const UnsurveyedArguments& arguments,
                                           const UnsurveyedObserver& observer) {
  if (arguments.captures.empty()) {
    return write_plan(arguments, observer).map([] { return UnsurveyedOutcome::kPlan; });
  }
  const WorkFolder work;
  if (!work.is_there()) {
    return make_error(ErrorKind::kUnavailable,
                      fs::temp_directory_path().string() + ": cannot be written");
  }
  RAYLOC_TRY(check_output(arguments.out, arguments.site, arguments.force));
  const std::string learned = work.file("learned");
  const auto chains =
      run_rechain({arguments.site, arguments.captures, "", {}, learned, true, true}, observer);
  RAYLOC_TRY(chains);
  if (observer.on_chains) {
    observer.on_chains(*chains);
  }
  if (is_one_alone(arguments.captures)) {
    observer.note(
        "chains that were learned with one access point alone may be wrong although they fit: its "
        "regions are wide; verify them with more access points or a survey");
  }
  const auto places = places_in(learned, arguments.captures);
  RAYLOC_TRY(places);
  UnsurveyedReport report;
  report.chains = *chains;
  report.bursts = places->bursts;
  report.places = places->points.size();
  if (places->points.size() < kFewestPoints) {
    observer.note(
        fmt::format("{} of {} bursts have a reliable position, and walls need {}: walls stay as "
                    "in the plan; record a device that is carried through the whole room while all "
                    "access points receive it",
                    places->points.size(),
                    places->bursts,
                    kFewestPoints));
    return keep_plan(learned, report, arguments, observer).map([] {
      return UnsurveyedOutcome::kChains;
    });
  }
  observer.note(fmt::format(
      "{} of {} bursts have a reliable position, to {:.3f} m: they are the survey of the walls",
      places->points.size(),
      places->bursts,
      places->sigma));
  return fit_room(
      learned, work.file("places.csv"), *places, std::move(report), arguments, observer);
}

}  // namespace rayloc
