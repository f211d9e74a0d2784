#include "engine/calibrate/input_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/log_odds.h"
#include "engine/base/median.h"
#include "engine/calibrate/access_point_fit.h"

namespace rayloc {
namespace {

using Correlations = std::vector<std::optional<double>>;  // of each point

// Where a point really was, if the survey made one mistake.
struct Mistake {
  std::string meaning;
  std::function<Vec3d(std::size_t)> place;
};

std::vector<Mistake> mistakes_of_survey(std::span<const CalibrationPoint> points) {
  const std::size_t count = points.size();
  const auto at = [=](std::size_t i) { return points[i % count].position; };
  return {
      {"with x and y exchanged",
       [=](std::size_t i) {
         return Vec3d{at(i).y, at(i).x, at(i).z};
       }},
      {"with the sign of x changed",
       [=](std::size_t i) {
         return Vec3d{-at(i).x, at(i).y, at(i).z};
       }},
      {"with the sign of y changed",
       [=](std::size_t i) {
         return Vec3d{at(i).x, -at(i).y, at(i).z};
       }},
      {"with the signs of x and y changed",
       [=](std::size_t i) {
         return Vec3d{-at(i).x, -at(i).y, at(i).z};
       }},
      {"with every place moved one row up", [=](std::size_t i) { return at(i + 1); }},
      {"with every place moved one row down", [=](std::size_t i) { return at(i + count - 1); }}};
}

bool is_inside(const RoomModel& room, const Vec3d& p) {
  return p.x >= room.bounds_min.x && p.x <= room.bounds_max.x && p.y >= room.bounds_min.y &&
         p.y <= room.bounds_max.y && p.z >= room.bounds_min.z && p.z <= room.bounds_max.z;
}

// The measurement of `from`'s chains in the order of `to`'s; empty when they are not the same.
std::vector<std::complex<double>> reordered(const std::vector<std::complex<double>>& h,
                                            const RoomAccessPoint& from,
                                            const RoomAccessPoint& to,
                                            std::size_t tones) {
  if (from.cores.size() != to.cores.size()) {
    return {};
  }
  std::vector<std::complex<double>> result;
  for (const std::uint8_t core : to.cores) {
    const auto found = std::find(from.cores.begin(), from.cores.end(), core);
    if (found == from.cores.end()) {
      return {};
    }
    const auto row = h.begin() + (found - from.cores.begin()) * static_cast<std::ptrdiff_t>(tones);
    result.insert(result.end(), row, row + static_cast<std::ptrdiff_t>(tones));
  }
  return result;
}

struct Hypothesis {
  std::size_t recorded = 0;  // the access point whose recording it is said to be
  std::size_t pose = 0;      // the one that stands where it was recorded
  std::function<Vec3d(std::size_t)> place;
};

// How well the hypothesis explains each point; nothing where it was not heard or is not reached.
Correlations explain(const RoomModel& room,
                     std::span<const CalibrationPoint> points,
                     const Hypothesis& hypothesis) {
  const auto& aps = room.access_points;
  std::vector<CalibrationSample> samples;
  std::vector<std::size_t> point_of;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& h = points[i].h.at(hypothesis.recorded);
    if (h.empty()) {
      continue;
    }
    auto rows = reordered(h, aps[hypothesis.recorded], aps[hypothesis.pose], room.grid.size());
    if (!rows.empty()) {
      samples.push_back({hypothesis.place(i), std::move(rows)});
      point_of.push_back(i);
    }
  }
  Correlations result(points.size());
  const AccessPointCalibrator calibrator(room, hypothesis.pose, std::move(samples));
  if (const auto fit = calibrator.fit_gains()) {
    const Correlations each = calibrator.correlations(&*fit);
    for (std::size_t i = 0; i < each.size(); ++i) {
      result[point_of[i]] = each[i];
    }
  }
  return result;
}

// Paired comparison of two hypotheses.
class Comparison {
 public:
  void add(const Correlations& stated, const Correlations& other) {
    for (std::size_t i = 0; i < stated.size(); ++i) {
      if (stated[i] && other[i]) {
        difference_.push_back(*other[i] - *stated[i]);
        stated_ += *stated[i];
        other_ += *other[i];
      }
    }
  }
  // Mean difference over its standard error; 0 where nothing can be said.
  double significance() const {
    const auto count = static_cast<double>(difference_.size());
    if (difference_.size() < kLeastPairs) {
      return 0.0;
    }
    double mean = 0.0;
    for (const double d : difference_) {
      mean += d / count;
    }
    double square = 0.0;
    for (const double d : difference_) {
      square += (d - mean) * (d - mean);
    }
    const double error = std::sqrt(square / (count * (count - 1.0)));
    return error > 0.0 ? mean / error : 0.0;
  }
  bool empty() const { return difference_.empty(); }
  double stated() const { return stated_ / static_cast<double>(difference_.size()); }
  double other() const { return other_ / static_cast<double>(difference_.size()); }

 private:
  std::vector<double> difference_;
  double stated_ = 0.0;
  double other_ = 0.0;
};

std::string number_text(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 2);
  return {text.data(), end.ptr};
}

std::string concatenated(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) {
    text += part;
  }
  return text;
}

struct Finding {
  double significance = kClearly;  // to be exceeded
  std::string message;             // empty: no mistake is clearly better
};

// An access point whose place explains the recording clearly better than its own.
void compare_access_points(const RoomModel& room,
                           std::span<const CalibrationPoint> points,
                           const std::vector<Correlations>& stated,
                           Finding& finding) {
  const auto as_stated = [&](std::size_t i) { return points[i].position; };
  for (std::size_t i = 0; i < stated.size(); ++i) {
    for (std::size_t j = 0; j < stated.size(); ++j) {
      Comparison comparison;
      if (i != j) {
        comparison.add(stated[i], explain(room, points, {i, j, as_stated}));
      }
      if (comparison.significance() > finding.significance) {
        const std::string& own = room.access_points[i].id;
        const std::string& other = room.access_points[j].id;
        finding = {comparison.significance(),
                   concatenated({"the recording given for access point '",
                                 own,
                                 "' fits the place of access point '",
                                 other,
                                 "' (mean correlation ",
                                 number_text(comparison.other()),
                                 ") better than that of '",
                                 own,
                                 "' (",
                                 number_text(comparison.stated()),
                                 "): are the recordings of the two exchanged?"})};
      }
    }
  }
}

// "(0.71 at ap1, 0.66 at ap2)", of those where both hypotheses say something.
std::string means_text(const RoomModel& room,
                       const std::vector<Comparison>& each,
                       double (Comparison::*mean)() const) {
  std::string text;
  for (std::size_t ap = 0; ap < each.size(); ++ap) {
    if (!each[ap].empty()) {
      text += (text.empty() ? "(" : ", ") + number_text((each[ap].*mean)()) + " at " +
              room.access_points[ap].id;
    }
  }
  return text + ")";
}

// "(-1.54, 1.10, 1.20)", the point, as stated, at which the other hypothesis is better by most.
std::string clearest_point(std::span<const CalibrationPoint> points,
                           const std::vector<Correlations>& stated,
                           const std::vector<Correlations>& other) {
  std::vector<double> better(points.size());
  for (std::size_t ap = 0; ap < stated.size(); ++ap) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (stated[ap][i] && other[ap][i]) {
        better[i] += *other[ap][i] - *stated[ap][i];
      }
    }
  }
  const auto most = std::max_element(better.begin(), better.end()) - better.begin();
  const Vec3d& p = points[static_cast<std::size_t>(most)].position;
  return concatenated({"(", number_text(p.x), ", ", number_text(p.y), ", ", number_text(p.z), ")"});
}

// A mistake of the points shows at all access points.
void compare_places(const RoomModel& room,
                    std::span<const CalibrationPoint> points,
                    const std::vector<Correlations>& stated,
                    Finding& finding) {
  for (const Mistake& mistake : mistakes_of_survey(points)) {
    Comparison comparison;
    std::vector<Comparison> each(stated.size());
    std::vector<Correlations> other;
    bool possible = true;  // the truth lies inside of the room
    for (std::size_t i = 0; i < points.size(); ++i) {
      possible = possible && is_inside(room, mistake.place(i));
    }
    for (std::size_t ap = 0; possible && ap < stated.size(); ++ap) {
      other.push_back(explain(room, points, {ap, ap, mistake.place}));
      comparison.add(stated[ap], other.back());
      each[ap].add(stated[ap], other.back());
    }
    if (comparison.significance() > finding.significance) {
      finding = {comparison.significance(),
                 concatenated({"the recordings fit the points ",
                               mistake.meaning,
                               " (mean correlation ",
                               means_text(room, each, &Comparison::other).substr(1),
                               " better than the points as stated ",
                               means_text(room, each, &Comparison::stated),
                               ", most clearly the one stated to be at ",
                               clearest_point(points, stated, other),
                               ": check the columns, axes and rows of the points"})};
    }
  }
}

// The usual fit at an access point.
struct Usual {
  double share = 0.0;
  double log_odds = 0.0;
  double deviation = 0.0;
};

std::optional<Usual> usual_fit(const std::vector<double>& shares) {
  if (shares.size() < kLeastPairs) {
    return std::nullopt;
  }
  // Shares that agree to the last digit are no reason to refuse the next one.
  constexpr double kLeastDeviation = 0.3;
  constexpr double kOfNormal = 1.4826;
  // How far the deviation of n values may be off itself: twice its relative error, 1.17 / sqrt(n).
  const double allowance = 1.0 + 2.0 * 1.17 / std::sqrt(static_cast<double>(shares.size()));
  Usual usual;
  usual.share = median(shares);
  usual.log_odds = log_odds(usual.share);
  std::vector<double> away;
  away.reserve(shares.size());
  for (const double share : shares) {
    away.push_back(std::abs(log_odds(share) - usual.log_odds));
  }
  usual.deviation = allowance * std::max(kOfNormal * median(std::move(away)), kLeastDeviation);
  return usual;
}

}  // namespace

std::vector<PointRefusal> misfitting_points(const RoomModel& room,
                                            std::span<const PointFit> fits,
                                            double PointFit::*share) {
  std::map<std::size_t, std::vector<double>> shares;  // by access point
  for (const PointFit& fit : fits) {
    shares[fit.access_point].push_back(fit.*share);
  }
  struct Sum {
    double deviations = 0.0;
    double count = 0.0;
    std::string own;
    std::string others;
  };
  std::map<std::size_t, Sum> sums;  // by point
  for (const auto& [ap, of_ap] : shares) {
    const auto usual = usual_fit(of_ap);
    for (const PointFit& fit : fits) {
      if (!usual || fit.access_point != ap) {
        continue;
      }
      Sum& sum = sums[fit.point];
      sum.deviations += (log_odds(fit.*share) - usual->log_odds) / usual->deviation;
      sum.count += 1.0;
      sum.own += (sum.own.empty() ? "" : ", ") + number_text(fit.*share) + " (" +
                 room.access_points.at(ap).id + ")";
      sum.others += (sum.others.empty() ? "" : ", ") + number_text(usual->share);
    }
  }
  std::vector<PointRefusal> refused;
  for (const auto& [point, sum] : sums) {
    if (sum.deviations / std::sqrt(sum.count) < -kFarBelow) {
      refused.push_back({point,
                         "fits its place by " + sum.own + " where the others fit by " + sum.others +
                             ": wrong place or time?"});
    }
  }
  return refused;
}

Expected<std::vector<PointRefusal>> check_calibration_inputs(
    const RoomModel& room, std::span<const CalibrationPoint> points) {
  std::vector<Correlations> stated;
  std::vector<PointFit> fits;
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    stated.push_back(
        explain(room, points, {ap, ap, [&](std::size_t i) { return points[i].position; }}));
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (stated[ap][i]) {
        fits.push_back({i, ap, *stated[ap][i], *stated[ap][i]});
      }
    }
  }
  Finding finding;
  compare_access_points(room, points, stated, finding);
  compare_places(room, points, stated, finding);
  if (!finding.message.empty()) {
    return bad_input(std::move(finding.message));
  }
  return misfitting_points(room, fits, &PointFit::before);
}

}  // namespace rayloc
