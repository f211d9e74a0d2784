#include "daemon/live/studio/walked_survey.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>

#include <nlohmann/json.hpp>

#include "daemon/site/survey/points_csv.h"
#include "daemon/site/survey/survey_file.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarthest = 10'000.0;  // [m], as for positions in site.toml

}  // namespace

WalkedSurvey::Frames WalkedSurvey::received() const {
  Frames received = frames_();
  for (auto& [name, count] : received) {
    const auto before = stay_->frames.find(name);
    const std::uint64_t then = before == stay_->frames.end() ? 0 : before->second;
    count -= std::min(count, then);
  }
  return received;
}

Expected<Json> WalkedSurvey::state() const {
  Json state = {{"file", file_.string()}, {"points", Json::array()}};
  std::error_code status;
  if (std::filesystem::exists(file_, status)) {
    // A file without a row is no error here.
    if (const auto points = load_points_csv(file_)) {
      for (const SurveyPoint& point : *points) {
        state["points"].push_back({point.position.x, point.position.y, point.position.z});
      }
    }
  }
  if (stay_) {
    const Vec3d& p = stay_->position;
    state["standing"] = {{"position", {p.x, p.y, p.z}},
                         {"seconds", to_seconds(std::chrono::system_clock::now() - stay_->since)},
                         {"frames", received()}};
  }
  return state;
}

Expected<void> WalkedSurvey::begin_stay(const Vec3d& position) {
  if (!(std::abs(position.x) < kFarthest && std::abs(position.y) < kFarthest &&
        std::abs(position.z) < kFarthest)) {
    return bad_input("state your place: x, y and z in metres");
  }
  stay_ = Stay{position, std::chrono::system_clock::now(), frames_()};
  return {};
}

Expected<void> WalkedSurvey::keep() {
  if (!stay_) {
    return bad_input("no place was tapped: tap your place first");
  }
  const Frames frames = received();
  if (std::all_of(frames.begin(), frames.end(), [](const auto& one) { return one.second == 0; })) {
    return make_error(ErrorKind::kUnavailable,
                      "no access point has received a frame since you tapped your place; does the "
                      "device send? Nothing was written");
  }
  auto file = SurveyFile::open(file_.string());
  RAYLOC_TRY(file);
  auto written = file->append({stay_->since, std::chrono::system_clock::now(), stay_->position, 0});
  if (written) {
    stay_.reset();
  }
  return written;
}

}  // namespace rayloc
