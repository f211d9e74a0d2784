#include "daemon/lab/reference/reference_site.h"

#include <cmath>
#include <string>
#include <utility>

#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

// The calibration unchanged, or with the new gains of chains whose phases have changed since.
Expected<std::string> calibration_text(const Site& site, const LearnedReference& learned) {
  if (!has_rotated_chains(learned.changes)) {
    return read_file(*site.calibration_file);
  }
  auto calibration = load_calibration_file(*site.calibration_file);
  RAYLOC_TRY(calibration);
  for (const DayChange& change : learned.changes) {
    const RoomAccessPoint& ap = learned.room.access_points[change.access_point];
    for (CalibratedAccessPoint& stated : calibration->access_points) {
      if (stated.id == ap.id && change.is_rotated && change.is_today_rotated) {
        stated.gains = ap.gains;
        for (std::size_t m = 0; m < stated.gain_sigma.size(); ++m) {
          stated.gain_sigma[m] = std::hypot(stated.gain_sigma[m], change.chains.sigma[m]);
        }
      }
    }
  }
  calibration->id = learned.room.calibration_id;
  return to_toml(*calibration);
}

// The reports of the calibration, where it has them.
Expected<void> copy_reports(const Site& site, const fs::path& out) {
  for (const char* name : {"report.json", "report.html"}) {
    if (const auto report = read_file(site.calibration_file->parent_path() / name)) {
      RAYLOC_TRY(write_file(out / name, *report));
    }
  }
  return {};
}

}  // namespace

Expected<void> write_reference_site(const Site& site,
                                    const LearnedReference& learned,
                                    const fs::path& out,
                                    bool force) {
  RAYLOC_TRY(prepare_output(out, force));
  const auto calibration = calibration_text(site, learned);
  RAYLOC_TRY(calibration);
  const fs::path file = out / "reference.toml";
  const std::string text = reference_toml(learned.references, learned.room, learned.points);
  RAYLOC_TRY(write_file(file, text));
  Site copy = site;
  copy.reference_file = file;
  RAYLOC_TRY(write_site(copy, *calibration, out));
  return copy_reports(site, out);
}

}  // namespace rayloc
