#include "daemon/lab/evaluate/truth.h"

#include <algorithm>

#include "daemon/site/survey/csv_table.h"
#include "daemon/site/survey/points_csv.h"

namespace rayloc {
namespace {

constexpr Duration kAfterPoint = std::chrono::milliseconds(100);
constexpr Duration kMaxTruthDistance = std::chrono::milliseconds(60);

using Iterator = std::vector<const LocationEstimate*>::const_iterator;

// The last in [begin, end], or `none`; of equal times the last one in the file.
const LocationEstimate* last_within(Iterator first, Iterator last, Timestamp begin, Timestamp end) {
  const auto after = std::upper_bound(
      first, last, end, [](Timestamp t, const LocationEstimate* e) { return t < e->time; });
  return after == first || (*std::prev(after))->time < begin ? nullptr : *std::prev(after);
}

const LocationEstimate* nearest(Iterator first, Iterator last, Timestamp time) {
  const auto distance = [&](Iterator i) {
    return (*i)->time < time ? time - (*i)->time : (*i)->time - time;
  };
  const auto after = std::lower_bound(
      first, last, time, [](const LocationEstimate* e, Timestamp t) { return e->time < t; });
  auto best = last;
  if (after != first) {
    best = std::prev(after);
  }
  if (after != last && (best == last || distance(after) < distance(best))) {
    best = after;
  }
  return best == last || distance(best) > kMaxTruthDistance ? nullptr : *best;
}

}  // namespace

Expected<std::vector<TruthPoint>> load_truth(const std::filesystem::path& file) {
  const auto table = CsvTable::load(file);
  RAYLOC_TRY(table);
  auto truth = read_truth(*table);
  if (truth && truth->empty()) {
    return bad_input(file.string() + ": no points, only a header");
  }
  return truth;
}

Expected<std::vector<TruthPoint>> read_truth(const CsvTable& table) {
  const bool instant = has_instants(table);
  const auto points = instant ? read_instants(table) : read_points(table);
  RAYLOC_TRY(points);
  std::vector<TruthPoint> truth;
  for (const SurveyPoint& point : *points) {
    truth.push_back({point.t_start, point.t_end, instant, point.position});
  }
  return truth;
}

std::vector<TruthPoint> shifted(std::vector<TruthPoint> truth, Duration offset) {
  for (TruthPoint& point : truth) {
    point.begin += offset;
    point.end += offset;
  }
  return truth;
}

std::vector<const LocationEstimate*> match(const std::vector<TruthPoint>& truth,
                                           const std::vector<PublishedEstimate>& estimates) {
  std::vector<const LocationEstimate*> by_time;
  by_time.reserve(estimates.size());
  for (const PublishedEstimate& published : estimates) {
    by_time.push_back(&published.estimate);
  }
  std::stable_sort(by_time.begin(), by_time.end(), [](const auto* a, const auto* b) {
    return a->time < b->time;
  });
  std::vector<const LocationEstimate*> matches;
  matches.reserve(truth.size());
  for (const TruthPoint& point : truth) {
    matches.push_back(
        point.instant
            ? nearest(by_time.begin(), by_time.end(), point.begin)
            : last_within(by_time.begin(), by_time.end(), point.begin, point.end + kAfterPoint));
  }
  return matches;
}

}  // namespace rayloc
