#include "daemon/lab/evaluate/comparison.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "daemon/lab/evaluate/evaluate_fingerprints.h"

namespace rayloc {
namespace {

std::vector<PublishedEstimate> select(const std::vector<PublishedEstimate>& estimates,
                                      const ComparisonRequest& request) {
  std::vector<PublishedEstimate> selected;
  std::copy_if(estimates.begin(),
               estimates.end(),
               std::back_inserter(selected),
               [&](const PublishedEstimate& e) {
                 return e.person == request.is_person && e.filtered == request.is_filtered &&
                        (request.target.empty() || e.target == request.target);
               });
  return selected;
}

std::string decimal_time(Timestamp time) {
  const auto milliseconds =
      std::chrono::floor<std::chrono::milliseconds>(time).time_since_epoch().count();
  return std::to_string(milliseconds / 1000) + "." +
         std::to_string(1000 + milliseconds % 1000).substr(1);
}

// Explains why no estimate matches any point, with a remedy.
Error nothing_matches(std::size_t all,
                      const std::vector<PublishedEstimate>& selected,
                      const std::vector<TruthPoint>& truth,
                      const ComparisonRequest& request) {
  std::string message = request.estimates + ": ";
  if (selected.empty()) {
    message += "none of " + std::to_string(all) + " estimates is a " +
               (request.is_filtered ? "filtered estimate" : "snapshot") + " of a " +
               (request.is_person ? "person" : "device") + "; see --estimate, --kind and --target";
    return {ErrorKind::kBadInput, message};
  }
  const auto by_time = [](const PublishedEstimate& a, const PublishedEstimate& b) {
    return a.estimate.time < b.estimate.time;
  };
  const auto [first, last] = std::minmax_element(selected.begin(), selected.end(), by_time);
  message += "no estimate lies in the times of the truth: estimates from " +
             decimal_time(first->estimate.time) + " to " + decimal_time(last->estimate.time) +
             ", truth from " + decimal_time(truth.front().begin) + " to " +
             decimal_time(truth.back().end) +
             "; --time-offset is added to the truth (rayloc send prints it)";
  return {ErrorKind::kBadInput, message};
}

// Checks that the options are consistent, before anything is read.
Expected<void> check(const ComparisonRequest& request) {
  const std::size_t given = (request.fingerprints.empty() ? 0U : 1U) +
                            (request.points.empty() ? 0U : 1U) +
                            (request.captures.empty() ? 0U : 1U);
  if (given != 0 && (given != 3 || request.site.empty())) {
    return make_error(ErrorKind::kUsage,
                      "the control by fingerprints needs all of --fingerprints, --points (the "
                      "survey's recordings and csv), --capture (the recordings that the estimates "
                      "were made of) and --site");
  }
  return {};
}

Expected<void> add_controls(const ComparisonRequest& request,
                            const Observer& observer,
                            Comparison& comparison) {
  if (request.site.empty()) {
    return {};
  }
  auto site = load_site(request.site);
  RAYLOC_TRY(site);
  comparison.site = *std::move(site);
  if (!comparison.site->has_bounds) {
    return make_error(ErrorKind::kConfiguration,
                      request.site +
                          ": the site states no [bounds], which the room-centre control "
                          "needs; add them to site.toml or leave --site out");
  }
  const Vec3d centre = 0.5 * (comparison.site->bounds_min + comparison.site->bounds_max);
  for (const TruthPoint& point : comparison.truth) {
    comparison.controls.room_centre.push_back(horizontal_distance(centre, point.position));
  }
  if (request.fingerprints.empty()) {
    return {};
  }
  const FingerprintRequest fingerprints{request.fingerprints,
                                        request.points,
                                        request.captures,
                                        request.is_person,
                                        request.is_person ? "" : request.target};
  auto errors = fingerprint_errors(*comparison.site, fingerprints, comparison.recorded, observer);
  RAYLOC_TRY(errors);
  comparison.controls.fingerprint = *std::move(errors);
  return {};
}

}  // namespace

Expected<Comparison> compare_with_truth(const ComparisonRequest& request,
                                        const Observer& observer) {
  RAYLOC_TRY(check(request));
  auto truth = load_truth(request.truth);
  RAYLOC_TRY(truth);
  const auto estimates = load_estimates(request.estimates);
  RAYLOC_TRY(estimates);
  Comparison comparison;
  comparison.recorded = *std::move(truth);
  comparison.truth = shifted(comparison.recorded, request.time_offset);
  comparison.estimates = select(*estimates, request);
  comparison.matches = match(comparison.truth, comparison.estimates);
  if (std::all_of(comparison.matches.begin(), comparison.matches.end(), [](const auto* m) {
        return m == nullptr;
      })) {
    return tl::make_unexpected(
        nothing_matches(estimates->size(), comparison.estimates, comparison.truth, request));
  }
  comparison.results.reserve(comparison.truth.size());
  for (std::size_t i = 0; i < comparison.truth.size(); ++i) {
    comparison.results.push_back(evaluate_point(comparison.truth[i], comparison.matches[i]));
  }
  RAYLOC_TRY(add_controls(request, observer, comparison));
  return comparison;
}

}  // namespace rayloc
