#include "daemon/lab/evaluate/comparison_plots.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "daemon/lab/draw/svg.h"
#include "daemon/lab/evaluate/evaluation_plots.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc {
namespace {

Expected<draw::Drawing> error_map(const Comparison& comparison) {
  const auto room = load_room_model(*comparison.site);
  RAYLOC_TRY(room);
  std::vector<draw::MapAntenna> antennas;
  for (const RoomAccessPoint& ap : room->access_points) {
    antennas.push_back({ap.id, ap.array.pose.position});
  }
  return draw_error_map(*room->scene, std::move(antennas), comparison.truth, comparison.matches);
}

std::vector<NamedErrors> error_curves(const Comparison& comparison) {
  std::vector<NamedErrors> curves(1);
  curves.front().name = "estimates";
  for (const PointResult& result : comparison.results) {
    curves.front().errors.push_back(result.error);
  }
  if (!comparison.controls.room_centre.empty()) {
    curves.push_back({"room centre", comparison.controls.room_centre});
  }
  if (!comparison.controls.fingerprint.empty()) {
    curves.push_back({"nearest fingerprint", comparison.controls.fingerprint});
  }
  return curves;
}

}  // namespace

Expected<void> write_comparison_plots(const std::filesystem::path& directory,
                                      const Comparison& comparison) {
  std::map<std::string, draw::Drawing> plots;
  plots["cdf.svg"] = draw_error_distributions(error_curves(comparison));
  plots["coverage.svg"] = draw_coverage(comparison.results);
  plots["reliability.svg"] =
      draw_reliability(stated_outcomes(comparison.truth, comparison.matches));
  if (comparison.site) {
    auto map = error_map(comparison);
    RAYLOC_TRY(map);
    plots["map.svg"] = *std::move(map);
  }
  for (const auto& [name, drawing] : plots) {
    RAYLOC_TRY(write_file(directory / name, draw::to_svg(drawing)));
  }
  return {};
}

}  // namespace rayloc
