#include "engine/person/person_localizer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/parallel.h"
#include "engine/grid/grid.h"
#include "engine/grid/lattice.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/cell_places.h"
#include "engine/posterior/posterior.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

// Cells for detailed evaluation: those within this of the best as a whole, in units of the
// tempered log-likelihood, and no more than kMaxClose.
constexpr double kCloseMargin = 25.0;
constexpr std::size_t kMaxClose = 600;  // a count of cells, chosen: bounds the time of a fix
constexpr double kNoMass = -1e4;        // [nat], chosen: no mass at all
// Radius about a place [m].
constexpr double kAbout = 0.3;
// Probability of a change at an access point that no person causes.
constexpr double kStrange = 0.02;
// A body this near to the transmitter [m] has strong echoes in all directions ...
constexpr double kBesideTransmitter = 0.6;
// ... detected above this share of the empty room's power, in the second strongest array.
constexpr double kStrongEcho = 0.05;
// Probability of a changed transmitter, where the observation cannot distinguish it.
constexpr double kSuspect = 0.5;

// Evidence of one array on every cell as a whole.
struct ArrayMap {
  const PersonObservation::Array* array;
  OtherPeople co_occupants;
  std::vector<double> whole;  // log-likelihood of every cell
  double floor = 0.0;         // of a change that no person causes, with its prior
  double no_person = 0.0;

  // Relative to the null model. An obstruction of one access point does not rule out places.
  double over_empty_room(double log_likelihood) const {
    return array->weight * (log_add(log_likelihood, floor) - no_person);
  }
};

// The cells for detailed evaluation, the best first.
std::vector<std::size_t> best_cells(std::span<const std::size_t> cells,
                                    const std::vector<double>& total,
                                    double likelihood_exponent) {
  double top = -std::numeric_limits<double>::infinity();
  for (const std::size_t cell : cells) {
    top = std::max(top, total[cell]);
  }
  const double least = top - kCloseMargin / likelihood_exponent;
  std::vector<std::size_t> best;
  std::copy_if(cells.begin(), cells.end(), std::back_inserter(best), [&](std::size_t cell) {
    return total[cell] >= least;
  });
  std::stable_sort(
      best.begin(), best.end(), [&](std::size_t a, std::size_t b) { return total[a] > total[b]; });
  best.resize(std::min(best.size(), kMaxClose));
  return best;
}

}  // namespace

class PersonLocalizer::Impl {
 public:
  Impl(std::shared_ptr<const RoomModel> room,
       PersonReference reference,
       const PersonLocalizerOptions& options,
       PersonCells person_cells)
      : room_(std::move(room)),
        reference_(std::move(reference)),
        options_(options),
        person_cells_(std::move(person_cells)),
        places_(person_cells_.samples * person_cells_.samples) {
    options_.burst.leaves_out_absent = true;
  }

  PersonObservation receive(std::span<const CsiFrame> frames) const;
  PersonMap map(const PersonObservation& observation,
                double likelihood_exponent,
                const PersonContext& context) const;
  LocationEstimate summarise(LocationEstimate estimate, const PersonMap& map) const;

  const PersonCells& person_cells() const { return person_cells_; }
  const RoomModel& room() const { return *room_; }
  const PersonReference& reference() const { return reference_; }
  const PersonLocalizerOptions& options() const { return options_; }

 private:
  std::vector<std::size_t> clear_cells(const PersonContext& context) const;
  CellSet evaluated_cells(const PersonContext& context) const;
  ArrayMap whole_map(const PersonObservation::Array& array,
                     std::span<const std::size_t> cells,
                     std::span<const PersonSample> others) const;
  std::vector<double> close_map(const std::vector<ArrayMap>& arrays,
                                std::span<const std::size_t> cells) const;
  void choose_places(std::span<const std::size_t> cells,
                     std::span<const double> samples,
                     PersonMap& map) const;
  double misfit_of(const std::vector<ArrayMap>& arrays,
                   const PersonSample& best,
                   PersonMap& map) const;
  bool is_transmitter_suspect(const std::vector<ArrayMap>& arrays, const PersonSample& best) const;

  std::shared_ptr<const RoomModel> room_;
  PersonReference reference_;
  PersonLocalizerOptions options_;
  PersonCells person_cells_;
  std::size_t places_;  // sample places of a cell
};

PersonObservation PersonLocalizer::Impl::receive(std::span<const CsiFrame> frames) const {
  PersonObservation observation;
  LocationEstimate& estimate = observation.estimate;
  estimate.accuracy_confidence = options_.accuracy_confidence;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return observation;
  }
  ObservationTally tally;
  for (std::size_t number = 0; number < person_cells_.links.size(); ++number) {
    const PersonLinkMap& link = person_cells_.links[number];
    const std::size_t access_point = reference_.links[number].access_point;
    auto burst = preprocess_burst(*room_, access_point, frames, options_.burst, estimate.warnings);
    if (!burst) {
      continue;
    }
    if (const auto dead = dead_chain(*burst)) {
      estimate.warnings.push_back(
          dead_chain_text(room_->access_points[access_point], *burst, *dead) +
          "; the access point is left out");
      continue;
    }
    auto observed = link.likelihood.observe(burst->h);
    // The cells' covariances hold the model's noise only; a burst with more noise counts less.
    const double weight = std::min(1.0, reference_.person.noise / observed.noise);
    tally.add(room_->access_points[access_point], *burst);
    observation.arrays.push_back({number, std::move(observed), weight});
  }
  tally.fill(frames, estimate);
  if (observation.arrays.empty()) {
    estimate.reason = no_usable_reference_csi(estimate.warnings);
  }
  return observation;
}

// Cells that a person can occupy, clear of the others.
std::vector<std::size_t> PersonLocalizer::Impl::clear_cells(const PersonContext& context) const {
  const Grid& grid = person_cells_.walkable.grid;
  const TargetBody& body = reference_.person.body;
  const double apart = 2.0 * std::max(body.semi_axes[0], body.semi_axes[1]);
  std::vector<std::size_t> cells;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const Vec3d centre = grid.centre(cell);
    const auto off = [&](const PersonSample& sample) {
      return norm(centre - person_cells_.place_of(sample));
    };
    if (person_cells_.walkable.free[cell] != 0 &&
        (!context.about || off(*context.about) < kAbout) &&
        std::none_of(context.others.begin(), context.others.end(), [&](const PersonSample& other) {
          return off(other) < apart;
        })) {
      cells.push_back(cell);
    }
  }
  return cells;
}

CellSet PersonLocalizer::Impl::evaluated_cells(const PersonContext& context) const {
  if (context.cells.empty()) {
    return {};
  }
  const auto free =
      std::count(person_cells_.walkable.free.begin(), person_cells_.walkable.free.end(), 1);
  return CellSet::with_sample(context.cells, context.sample, static_cast<std::size_t>(free));
}

ArrayMap PersonLocalizer::Impl::whole_map(const PersonObservation::Array& array,
                                          std::span<const std::size_t> cells,
                                          std::span<const PersonSample> others) const {
  const PersonLinkMap& link = person_cells_.links[array.link];
  std::vector<PersonCandidate> people;
  for (const PersonSample& other : others) {
    people.push_back({&link.cells[other.cell], other.sample});
  }
  ArrayMap map{&array,
               link.likelihood.co_occupants(people, reference_.person),
               {},
               -std::numeric_limits<double>::infinity(),
               0.0};
  const auto likelihood = [&](const PersonGaussian& gaussian) {
    return link.likelihood.log_likelihood(gaussian, array.observed, map.co_occupants);
  };
  for (const PersonGaussian& changed : link.changed) {
    map.floor = std::max(map.floor, likelihood(changed) + std::log(kStrange));
  }
  map.no_person = likelihood(link.no_person);
  map.whole.resize(person_cells_.walkable.grid.size());
  parallel_for(cells.size(), 32, [&](std::size_t n) {
    if (n + 1 < cells.size()) {
      fetch(link.cells[cells[n + 1]].whole.whitener);
    }
    map.whole[cells[n]] = likelihood(link.cells[cells[n]].whole);
  });
  return map;
}

// [cell][sample place], relative to the null model, summed over all arrays.
std::vector<double> PersonLocalizer::Impl::close_map(const std::vector<ArrayMap>& arrays,
                                                     std::span<const std::size_t> cells) const {
  std::vector<double> samples(cells.size() * places_);
  parallel_for(cells.size(), 8, [&](std::size_t n) {
    const std::span<double> sum(samples.data() + n * places_, places_);
    std::vector<double> one(places_);
    for (const ArrayMap& map : arrays) {
      const PersonLinkMap& link = person_cells_.links[map.array->link];
      link.likelihood.log_likelihood(
          link.cells[cells[n]], map.array->observed, map.co_occupants, one);
      for (std::size_t p = 0; p < places_; ++p) {
        sum[p] += map.over_empty_room(one[p]);
      }
    }
  });
  return samples;
}

// Chooses the best sample place of every cell, unless a better one is near.
void PersonLocalizer::Impl::choose_places(std::span<const std::size_t> cells,
                                          std::span<const double> samples,
                                          PersonMap& map) const {
  std::vector<std::pair<double, PersonSample>> best;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const auto of_cell = samples.subspan(n * places_, places_);
    const auto top = std::max_element(of_cell.begin(), of_cell.end());
    best.push_back({*top, {cells[n], static_cast<std::size_t>(top - of_cell.begin())}});
  }
  std::stable_sort(
      best.begin(), best.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [value, sample] : best) {
    const Vec3d here = person_cells_.place_of(sample);
    const bool is_apart =
        std::none_of(map.places.begin(), map.places.end(), [&](const PersonSample& better) {
          return norm(here - person_cells_.place_of(better)) < PersonMap::kApart;
        });
    if (is_apart) {
      map.places.push_back(sample);
    }
    if (map.places.size() == PersonMap::kPlaces) {
      break;
    }
  }
}

// Misfit of the arrays at the best place, 1 as expected; adds warnings on unexplained arrays.
double PersonLocalizer::Impl::misfit_of(const std::vector<ArrayMap>& arrays,
                                        const PersonSample& best,
                                        PersonMap& map) const {
  double most = 1.0;
  double explained = 0.0;
  std::vector<double> one(places_);
  for (const ArrayMap& of : arrays) {
    const PersonLinkMap& link = person_cells_.links[of.array->link];
    const PersonPlace& place = link.cells[best.cell];
    link.likelihood.log_likelihood(place, of.array->observed, of.co_occupants, one);
    map.best_log_likelihood += of.array->weight * log_add(one[best.sample], of.floor);
    if (one[best.sample] < of.floor) {
      map.warnings.push_back(
          "access point " + room_->access_points[reference_.links[of.array->link].access_point].id +
          ": its channel has changed as one person does not change it");
      continue;
    }
    explained += 1.0;
    most = std::max(
        most,
        of.array->weight *
            link.likelihood.misfit({&place, best.sample}, of.array->observed, of.co_occupants));
  }
  map.is_explained = explained > 0.0;
  // If no person explains the change at one access point, the others get less weight, too.
  return map.is_explained ? most * static_cast<double>(arrays.size()) / explained : most;
}

// One body obstructs one line of sight; a moved or covered transmitter changes all links. A body
// right beside it explains that best, because its echoes are strong and not known well.
bool PersonLocalizer::Impl::is_transmitter_suspect(const std::vector<ArrayMap>& arrays,
                                                   const PersonSample& best) const {
  const Vec3d off = person_cells_.walkable.grid.centre(best.cell) - reference_.transmitter.position;
  if (std::hypot(off.x, off.y) > kBesideTransmitter) {
    return false;
  }
  const auto strong = std::count_if(arrays.begin(), arrays.end(), [&](const ArrayMap& of) {
    const PersonLinkMap& link = person_cells_.links[of.array->link];
    return link.likelihood.echo_power({&link.cells[best.cell], best.sample}) > kStrongEcho;
  });
  return strong > 1;
}

PersonMap PersonLocalizer::Impl::map(const PersonObservation& observation,
                                     double likelihood_exponent,
                                     const PersonContext& context) const {
  PersonMap map;
  std::vector<double>& total = map.log_likelihood;
  total.assign(person_cells_.walkable.grid.size(), kNoMass);
  map.evaluated = evaluated_cells(context);
  const std::vector<std::size_t> cells =
      map.evaluated.is_all() ? clear_cells(context) : map.evaluated.cells;
  if (cells.empty()) {  // the others occupy all cells
    map.is_explained = false;
    map.presence = kNoMass;
    return map;
  }
  std::vector<ArrayMap> arrays;
  for (const PersonObservation::Array& array : observation.arrays) {
    arrays.push_back(whole_map(array, cells, context.others));
  }
  for (const std::size_t cell : cells) {
    total[cell] = 0.0;
    for (const ArrayMap& one : arrays) {
      total[cell] += one.over_empty_room(one.whole[cell]);
    }
  }
  const std::vector<std::size_t> close = best_cells(cells, total, likelihood_exponent);
  const auto samples = close_map(arrays, close);
  choose_places(close, samples, map);
  // The residual at the best place is an error at all places: reduce the burst's weight.
  map.misfit = misfit_of(arrays, map.places.front(), map);
  const double exponent = likelihood_exponent / map.misfit;
  map.is_transmitter_suspect = is_transmitter_suspect(arrays, map.places.front());
  const Lattice lattice = person_cells_.lattice();
  for (std::size_t n = 0; n < close.size(); ++n) {
    const auto [log_mean, mass] =
        summarise_places(lattice, {samples.data() + n * places_, places_}, exponent);
    total[close[n]] = log_mean;
    map.within.emplace_back(close[n], mass);
  }
  std::vector<double> walkable;
  walkable.reserve(cells.size());
  for (const std::size_t cell : cells) {
    total[cell] *= exponent;
    walkable.push_back(total[cell]);
  }
  map.presence = log_mean_exp(walkable, 1.0, map.evaluated.weights);
  return map;
}

LocationEstimate PersonLocalizer::Impl::summarise(LocationEstimate estimate,
                                                  const PersonMap& map) const {
  estimate.warnings.insert(estimate.warnings.end(), map.warnings.begin(), map.warnings.end());
  if (!map.is_explained) {
    estimate.reason = "the room has changed as no single person would change it";
    return estimate;
  }
  if (map.is_transmitter_suspect) {
    estimate.warnings.emplace_back(
        "the channel has changed as by a person right next to the transmitter; it may have been "
        "moved or covered");
  }
  if (map.presence < kPresence) {
    estimate.reason = "no person detected: the room is as it was when empty";
    return estimate;
  }
  summarise_posterior(person_cells_.walkable.grid,
                      map.log_likelihood,
                      {1.0,
                       options_.accuracy_confidence,
                       options_.max_hypotheses,
                       map.is_transmitter_suspect ? kSuspect : kPersonOutlier},
                      estimate,
                      map.within);
  estimate.ambiguous = estimate.ambiguous || map.is_transmitter_suspect;
  return estimate;
}

Expected<PersonLocalizer> PersonLocalizer::create(std::shared_ptr<const RoomModel> room,
                                                  PersonReference reference,
                                                  const PersonLocalizerOptions& options) {
  if (room == nullptr || room->scene == nullptr) {
    return make_error(ErrorKind::kInternal, "a localizer needs a room with a scene");
  }
  if (!(room->bounds_max.x > room->bounds_min.x && room->bounds_max.y > room->bounds_min.y)) {
    return make_error(ErrorKind::kConfiguration, "the room's bounds are empty");
  }
  if (reference.links.empty()) {
    return make_error(ErrorKind::kConfiguration, "the reference is of no access point");
  }
  auto person_cells = make_person_cells(*room, reference, options.cell, options.depth);
  RAYLOC_TRY(person_cells);
  return PersonLocalizer(std::make_unique<Impl>(
      std::move(room), std::move(reference), options, *std::move(person_cells)));
}

PersonLocalizer::PersonLocalizer(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
PersonLocalizer::~PersonLocalizer() = default;
PersonLocalizer::PersonLocalizer(PersonLocalizer&&) noexcept = default;
PersonLocalizer& PersonLocalizer::operator=(PersonLocalizer&&) noexcept = default;

LocationEstimate PersonLocalizer::locate(std::span<const CsiFrame> frames) const {
  return locate(frames, reference().person.likelihood_exponent);
}
LocationEstimate PersonLocalizer::locate(std::span<const CsiFrame> frames,
                                         double likelihood_exponent) const {
  PersonObservation observation = receive(frames);
  if (observation.arrays.empty()) {
    return std::move(observation.estimate);
  }
  const PersonMap found = map(observation, likelihood_exponent);
  return summarise(std::move(observation.estimate), found);
}
PersonObservation PersonLocalizer::receive(std::span<const CsiFrame> frames) const {
  return impl_->receive(frames);
}
PersonMap PersonLocalizer::map(const PersonObservation& observation,
                               double likelihood_exponent,
                               const PersonContext& context) const {
  RAYLOC_CHECK(!observation.arrays.empty());
  return impl_->map(observation, likelihood_exponent, context);
}
LocationEstimate PersonLocalizer::summarise(LocationEstimate estimate, const PersonMap& map) const {
  return impl_->summarise(std::move(estimate), map);
}
const WalkableArea& PersonLocalizer::walkable_area() const {
  return impl_->person_cells().walkable;
}
const RoomModel& PersonLocalizer::room() const { return impl_->room(); }
const PersonReference& PersonLocalizer::reference() const { return impl_->reference(); }
const PersonLocalizerOptions& PersonLocalizer::options() const { return impl_->options(); }

}  // namespace rayloc
