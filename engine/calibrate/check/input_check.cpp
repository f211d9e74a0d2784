#include "engine/calibrate/check/input_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "engine/calibrate/check/array_mistakes.h"
#include "engine/calibrate/check/place_mistakes.h"
#include "engine/calibrate/check/stated_survey.h"
#include "engine/calibrate/fixed_text.h"

namespace rayloc {
namespace {

using MistakeKind = TriedMistake::Kind;
using Comparisons = std::vector<PairedComparison>;  // per access point

// A mistake, the recordings' meanings under it, and how well these explain the recordings.
struct Candidate {
  TriedMistake reported;
  std::vector<Meant> meant;
  std::vector<Correlations> explained;  // for each of these
};

std::string concatenated(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) {
    text += part;
  }
  return text;
}

std::string quoted(const std::string& id) { return "'" + id + "'"; }

TriedMistake tried(MistakeKind kind, const PairedComparison& comparison) {
  TriedMistake mistake;
  mistake.kind = kind;
  mistake.stated = comparison.stated();
  mistake.explained = comparison.other();
  mistake.gained = comparison.gained();
  mistake.significance = comparison.significance();
  return mistake;
}

// "(0.71 at ap1, 0.66 at ap2)", for access points with a value under both hypotheses.
std::string means_text(const RoomModel& room,
                       const Comparisons& each,
                       double (PairedComparison::*mean)() const) {
  std::string text;
  for (std::size_t ap = 0; ap < each.size(); ++ap) {
    if (!each[ap].empty()) {
      text += (text.empty() ? "(" : ", ") + fixed_text((each[ap].*mean)()) + " at " +
              room.access_points[ap].id;
    }
  }
  return text + ")";
}

// "(-1.54, 1.10, 1.20)", the point, as stated, at which the other hypothesis gains most.
std::string clearest_point(const StatedSurvey& survey, const std::vector<Correlations>& other) {
  std::vector<double> better(survey.points().size());
  for (std::size_t ap = 0; ap < other.size(); ++ap) {
    const Correlations& stated = survey.stated()[ap];
    for (std::size_t i = 0; i < stated.size(); ++i) {
      if (stated[i] && other[ap][i]) {
        better[i] += *other[ap][i] - *stated[i];
      }
    }
  }
  const auto most = std::max_element(better.begin(), better.end()) - better.begin();
  const Vec3d& p = survey.points()[static_cast<std::size_t>(most)].position;
  return concatenated({"(", fixed_text(p.x), ", ", fixed_text(p.y), ", ", fixed_text(p.z), ")"});
}

// A mistake of the points affects all access points.
std::vector<Candidate> try_places(const StatedSurvey& survey) {
  std::vector<Candidate> all;
  const std::size_t count = survey.stated().size();
  for (const PlaceMistake& mistake : mistakes_of_places(survey.room(), survey.points())) {
    PairedComparison comparison;
    Comparisons each(count);
    std::vector<Meant> meant;
    std::vector<Correlations> other;
    for (std::size_t ap = 0; ap < count; ++ap) {
      meant.push_back({ap, ap, mistake.place, {}});
      other.push_back(survey.other(meant.back()));
      comparison.add(survey.stated()[ap], other.back());
      each[ap].add(survey.stated()[ap], other.back());
    }
    if (comparison.empty()) {
      continue;
    }
    TriedMistake one = tried(MistakeKind::kPlaces, comparison);
    one.what = "the points " + mistake.meaning;
    one.remedy = "check the columns, axes and rows of the points";
    one.message = concatenated({"the recordings fit the points ",
                                mistake.meaning,
                                " (mean correlation ",
                                means_text(survey.room(), each, &PairedComparison::other).substr(1),
                                " better than the points as stated ",
                                means_text(survey.room(), each, &PairedComparison::stated),
                                ", most clearly the one stated to be at ",
                                clearest_point(survey, other),
                                ": ",
                                one.remedy});
    all.push_back({std::move(one), std::move(meant), std::move(other)});
  }
  return all;
}

// Per access point: the one whose place its recording is assigned to; itself where as stated.
using Assignment = std::vector<std::size_t>;

// One recording given for another access point, any two exchanged, and, for up to kAllOrders access
// points, every order.
std::set<Assignment> other_assignments(const StatedSurvey& survey) {
  const std::size_t count = survey.stated().size();
  Assignment own(count);
  std::iota(own.begin(), own.end(), std::size_t{0});
  std::set<Assignment> all;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      Assignment moved = own;
      moved[i] = j;
      all.insert(moved);
      moved[j] = i;
      all.insert(moved);
    }
  }
  Assignment order = own;
  while (count <= kAllOrders && std::next_permutation(order.begin(), order.end())) {
    all.insert(order);
  }
  std::set<Assignment> recorded;  // access points without a recording stay as stated
  for (Assignment one : all) {
    for (std::size_t i = 0; i < count; ++i) {
      one[i] = survey.is_recorded(i) ? one[i] : i;
    }
    recorded.insert(std::move(one));
  }
  recorded.erase(own);
  return recorded;
}

struct MovedRecording {
  std::string from;
  std::string to;
  PairedComparison comparison;
};

TriedMistake reported(const std::vector<MovedRecording>& moved, TriedMistake mistake) {
  std::string fits;
  for (const MovedRecording& one : moved) {
    const std::string from = quoted(one.from);
    const std::string to = quoted(one.to);
    mistake.what += (mistake.what.empty() ? "" : ", ") +
                    concatenated({"the recording of access point ", from, " as that of ", to});
    mistake.remedy += (mistake.remedy.empty() ? "" : ", ") +
                      concatenated({"--capture ", one.to, "= with what is given for ", one.from});
    fits += (fits.empty() ? "the recording given for access point "
                          : ", and that given for access point ") +
            concatenated({from,
                          " fits the place of access point ",
                          to,
                          " (mean correlation ",
                          fixed_text(one.comparison.other()),
                          ") better than that of ",
                          from,
                          " (",
                          fixed_text(one.comparison.stated()),
                          ")"});
  }
  mistake.message = concatenated({fits,
                                  ": are the recordings of ",
                                  moved.size() > 2 ? "these access points" : "the two",
                                  " exchanged? Then give ",
                                  mistake.remedy});
  return mistake;
}

std::vector<Candidate> try_recordings(const StatedSurvey& survey) {
  const std::size_t count = survey.stated().size();
  std::vector<std::vector<Correlations>> as(count, std::vector<Correlations>(count));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      if (i != j && survey.is_recorded(i)) {
        as[i][j] = survey.other({i, j, {}, {}});
      }
    }
  }
  std::vector<Candidate> all;
  for (const Assignment& assignment : other_assignments(survey)) {
    PairedComparison comparison;
    Candidate candidate;
    std::vector<MovedRecording> moved;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = assignment[i];
      if (i == j) {
        continue;
      }
      comparison.add(survey.stated()[i], as[i][j]);
      moved.push_back({survey.room().access_points[i].id, survey.room().access_points[j].id, {}});
      moved.back().comparison.add(survey.stated()[i], as[i][j]);
      candidate.meant.push_back({i, j, {}, {}});
      candidate.explained.push_back(as[i][j]);
    }
    const bool possible = std::none_of(
        moved.begin(), moved.end(), [](const auto& one) { return one.comparison.empty(); });
    if (possible) {
      candidate.reported = reported(moved, tried(MistakeKind::kRecordings, comparison));
      all.push_back(std::move(candidate));
    }
  }
  return all;
}

bool same(const Correlations& a, const Correlations& b) {
  constexpr double kRounding = 1e-6;  // of a correlation, chosen: below the effect of any mistake
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].has_value() != b[i].has_value() || (a[i] && std::abs(*a[i] - *b[i]) > kRounding)) {
      return false;
    }
  }
  return true;
}

// For one access point. Mistakes that no recording distinguishes are merged: a person can decide.
std::vector<Candidate> try_arrays(const StatedSurvey& survey, std::size_t ap) {
  const RoomAccessPoint& access_point = survey.room().access_points[ap];
  const Correlations& stated = survey.stated()[ap];
  struct Distinct {
    Meant meant;
    Correlations explained;
    std::string meaning;
    std::string remedy;
  };
  std::vector<Distinct> distinct;
  for (ArrayMistake& mistake : mistakes_of_array(access_point)) {
    Meant meant{ap, ap, {}, std::move(mistake.array)};
    Correlations explained = survey.other(meant);
    if (same(explained, stated)) {
      continue;
    }
    const auto known = std::find_if(distinct.begin(), distinct.end(), [&](const Distinct& one) {
      return same(one.explained, explained);
    });
    if (known == distinct.end()) {
      distinct.push_back({std::move(meant),
                          std::move(explained),
                          std::move(mistake.meaning),
                          std::move(mistake.remedy)});
    } else {
      known->meaning += ", or " + mistake.meaning;
      known->remedy += ", or " + mistake.remedy;
    }
  }
  std::vector<Candidate> all;
  for (Distinct& one : distinct) {
    PairedComparison comparison;
    comparison.add(stated, one.explained);
    if (comparison.empty()) {
      continue;
    }
    TriedMistake mistake = tried(MistakeKind::kArray, comparison);
    const std::string id = quoted(access_point.id);
    mistake.what = concatenated({"access point ", id, " ", one.meaning});
    mistake.remedy = concatenated({"in site.toml, of access point ", id, ": ", one.remedy});
    mistake.message = concatenated({"the recording of access point ",
                                    id,
                                    " fits it ",
                                    one.meaning,
                                    " (mean correlation ",
                                    fixed_text(mistake.explained),
                                    ") better than as the site states it (",
                                    fixed_text(mistake.stated),
                                    "): write ",
                                    mistake.remedy});
    all.push_back({std::move(mistake), {std::move(one.meant)}, {std::move(one.explained)}});
  }
  return all;
}

bool gains_less(const TriedMistake& a, const TriedMistake& b) { return a.gained < b.gained; }

// True if the places of the mistake explain their recordings better than other places do. For a
// survey in disorder some mistake explains more than the stated inputs, but no more than by chance.
bool is_above_chance(const StatedSurvey& survey, const Candidate& candidate) {
  PairedComparison comparison;
  for (std::size_t i = 0; i < candidate.meant.size(); ++i) {
    comparison.add(survey.by_chance(candidate.meant[i]), candidate.explained[i]);
  }
  return comparison.significance() > kClearly;
}

// The clear mistake with the largest gain.
std::optional<TriedMistake> clearest(const StatedSurvey& survey,
                                     const std::vector<Candidate>& candidates) {
  const Candidate* best = nullptr;
  for (const Candidate& one : candidates) {
    if (is_clear(one.reported) && (best == nullptr || gains_less(best->reported, one.reported)) &&
        is_above_chance(survey, one)) {
      best = &one;
    }
  }
  return best == nullptr ? std::nullopt : std::optional(best->reported);
}

double gained_by(const std::vector<TriedMistake>& mistakes) {
  return std::accumulate(mistakes.begin(), mistakes.end(), 0.0, [](double sum, const auto& one) {
    return sum + one.gained;
  });
}

void keep_better(std::vector<TriedMistake> mistakes, std::vector<TriedMistake>& found) {
  if (gained_by(mistakes) > gained_by(found)) {
    found = std::move(mistakes);
  }
}

}  // namespace

bool is_clear(const TriedMistake& mistake) {
  const bool of_site = mistake.kind == MistakeKind::kArray || mistake.kind == MistakeKind::kCarrier;
  const double least = of_site ? kSubstantial : 0.0;
  return mistake.significance > kClearly &&
         mistake.explained - mistake.stated > least * (1.0 - mistake.stated);
}

InputCheck check_calibration_inputs(const RoomModel& room,
                                    std::span<const CalibrationPoint> points) {
  InputCheck check;
  const StatedSurvey survey(room, points);
  const auto add = [&](const std::vector<Candidate>& candidates) {
    std::transform(candidates.begin(),
                   candidates.end(),
                   std::back_inserter(check.tried),
                   [](const Candidate& one) { return one.reported; });
    return clearest(survey, candidates);
  };
  for (const auto& candidates : {try_places(survey), try_recordings(survey)}) {
    if (auto best = add(candidates)) {
      keep_better({*std::move(best)}, check.found);
    }
  }
  std::vector<TriedMistake> arrays;  // per access point that is mounted otherwise
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    if (auto best = add(try_arrays(survey, ap))) {
      arrays.push_back(*std::move(best));
    }
  }
  keep_better(std::move(arrays), check.found);
  std::stable_sort(check.tried.begin(), check.tried.end(), [](const auto& a, const auto& b) {
    return gains_less(b, a);
  });
  if (check.found.empty()) {
    check.misfits = misfitting_points(room, survey.fits(), &PointFit::before);
  }
  return check;
}

std::vector<TriedMistake> try_carriers(const RoomModel& room,
                                       std::span<const CalibrationPoint> points) {
  const StatedSurvey survey(room, points);
  // Width of the whole channel, including the null tones at its edges.
  const double used = room.grid.spacing_hz *
                      static_cast<double>(room.grid.tone_index.back() - room.grid.tone_index[0]);
  constexpr double kNarrowest = 20e6;  // [Hz], IEEE 802.11-2020: channels are 20 MHz or a multiple
  const double width = kNarrowest * std::ceil(used / kNarrowest);
  std::vector<TriedMistake> all;
  for (const double widths : {-2.0, -1.0, 1.0, 2.0}) {
    const double centre_hz = room.grid.centre_hz + widths * width;
    PairedComparison comparison;
    for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
      comparison.add(survey.stated()[ap], survey.at_carrier(ap, centre_hz));
    }
    if (comparison.empty()) {
      continue;
    }
    TriedMistake mistake = tried(MistakeKind::kCarrier, comparison);
    const std::string centre = std::to_string(std::llround(centre_hz));
    mistake.what = "a channel with its centre at " + centre + " Hz";
    mistake.remedy = "in site.toml, [carrier]: centre_hz = " + centre + " and its channel";
    mistake.message = concatenated({"the recordings fit ",
                                    mistake.what,
                                    " (mean correlation ",
                                    fixed_text(mistake.explained),
                                    ") better than that of the site (",
                                    fixed_text(mistake.stated),
                                    "): write ",
                                    mistake.remedy});
    all.push_back(std::move(mistake));
  }
  return all;
}

}  // namespace rayloc
