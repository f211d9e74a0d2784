#include "daemon/lab/predict/prediction_report.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/base/arrays/npz_file.h"
#include "daemon/lab/draw/picture_bytes.h"
#include "daemon/lab/draw/room_map.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/plan/palette.h"
#include "engine/base/median.h"

namespace rayloc {
namespace {

void add(const Vec3d& v, std::vector<double>& into) { into.insert(into.end(), {v.x, v.y, v.z}); }

}  // namespace

double median_error(const PredictedPlace& place) { return median(place.error); }

double another_place_share(const PredictedPlace& place) { return misplaced_share(place.error); }

draw::Drawing prediction_picture(const Prediction& prediction, const RoomModel& room) {
  draw::RoomMap map;
  map.scene = room.scene.get();
  map.title = fmt::format("{}: predicted error, median {:.2f} m; {:.0f} % located at another place",
                          room.name,
                          prediction.median_m,
                          100.0 * prediction.another_place);
  map.value_name = "median error [m]";
  map.ring_meaning = fmt::format("sometimes more than {:.1f} m off", kAnotherPlace);
  map.lowest = 0.0;
  map.highest = kAnotherPlace;
  map.colour = [](double share) { return draw::share_colour(1.0 - share); };
  for (const PredictedPlace& place : prediction.places) {
    map.dots.push_back({place.position,
                        std::min(median_error(place), map.highest),
                        another_place_share(place) > 0.0});
  }
  for (const RoomAccessPoint& ap : room.access_points) {
    map.antennas.push_back({ap.id, ap.array.pose.position});
  }
  return draw_room_map(map);
}

std::string prediction_csv(const Prediction& prediction) {
  std::string text = "x,y,z,median_m,another_place_share\n";
  for (const PredictedPlace& place : prediction.places) {
    text += fmt::format("{:.3f},{:.3f},{:.3f},{:.4f},{:.3f}\n",
                        place.position.x,
                        place.position.y,
                        place.position.z,
                        median_error(place),
                        another_place_share(place));
  }
  return text;
}

Expected<void> write_npz(const Prediction& prediction, const std::string& path) {
  std::vector<double> position;
  std::vector<double> error;
  std::vector<double> estimate;
  for (const PredictedPlace& place : prediction.places) {
    add(place.position, position);
    error.insert(error.end(), place.error.begin(), place.error.end());
    for (const Vec3d& one : place.estimate) {
      add(one, estimate);
    }
  }
  const std::size_t places = prediction.places.size();
  const std::size_t draws = places == 0 ? 0 : error.size() / places;
  auto file = NpzFile::create(path);
  RAYLOC_TRY(file);
  file->add("position", position, {places, 3});
  file->add("error", error, {places, draws});
  file->add("estimate", estimate, {places, draws, 3});
  return file->close();
}

Expected<void> check_prediction_file(const std::string& file) {
  if (!is_npz(file) && !file.ends_with(".csv") && !file.ends_with(".svg") &&
      !file.ends_with(".png")) {
    return make_error(ErrorKind::kUsage, "--out " + file + ": write .png, .svg, .csv or .npz");
  }
  return {};
}

Expected<void> write_prediction(const Prediction& prediction,
                                const RoomModel& room,
                                const std::string& file) {
  if (is_npz(file)) {
    return write_npz(prediction, file);
  }
  if (file.ends_with(".csv")) {
    return write_file(file, prediction_csv(prediction));
  }
  const auto bytes = draw::picture_bytes(prediction_picture(prediction, room), file);
  return bytes ? write_file(file, *bytes) : tl::make_unexpected(bytes.error());
}

}  // namespace rayloc
