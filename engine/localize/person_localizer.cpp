#include "engine/localize/person_localizer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/localize/hearing.h"
#include "engine/localize/posterior.h"

namespace rayloc {
namespace {

// Of the squares that are looked at closely: within this of the best as a whole, in units of the
// tempered log-likelihood, and no more than this.
constexpr double kCloseMargin = 25.0;
constexpr std::size_t kMostClose = 600;
constexpr double kNowhere = -1e4;
// Sample places are at most this far apart, in wavelengths.
constexpr double kSampleStep = 0.125;
// Squares along each side for which the rays are traced together.
constexpr std::size_t kBlock = 2;
// Probability that what an access point hears has changed as no person changes it.
constexpr double kStrange = 0.02;
// A body this near to the transmitter [m] is strong in all directions ...
constexpr double kBesideTransmitter = 0.6;
// ... which is seen from this share of the empty room's power on, in the second strongest array.
constexpr double kStrongEcho = 0.05;
// Shares of the power that such a change is tried with.
constexpr std::array<double, 8> kChanges = {0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0};

// log mean exp of `values`.
double log_mean_exp(std::span<const double> values) {
  const double top = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double value : values) {
    sum += std::exp(value - top);
  }
  return top + std::log(sum / static_cast<double>(values.size()));
}

double log_sum(double a, double b) {
  return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
}

// One access point and its part of the map.
struct Station {
  PersonLikelihood likelihood;
  PersonScattering scattering;
  std::vector<PersonPlace> cells;  // empty where nobody can stand
  WhitenedGaussian nobody;
  std::vector<WhitenedGaussian> changed;
};

// What one array says of every square as a whole.
struct ArrayMap {
  const PersonHearing::Array* array;
  std::vector<double> whole;  // log-likelihood of every cell
  double floor = 0.0;         // of a change that no person makes, by its odds
  double nobody = 0.0;

  // Against nobody. What stands in the way of one access point does not rule out places.
  double against_nobody(double log_likelihood) const {
    return array->weight * (log_sum(log_likelihood, floor) - nobody);
  }
};

}  // namespace

class PersonLocalizer::Impl {
 public:
  Impl(std::shared_ptr<const RoomModel> room,
       PersonReference reference,
       const PersonLocalizerOptions& options)
      : room_(std::move(room)),
        reference_(std::move(reference)),
        options_(options),
        standing_(
            make_standing_room(*room_, reference_.person.body, reference_.area, options_.cell)) {}

  Expected<void> build();
  PersonHearing hear(std::span<const CsiFrame> frames) const;
  PersonMap map(const PersonHearing& hearing, double temper) const;
  LocationEstimate locate(std::span<const CsiFrame> frames, double temper) const;

  const StandingRoom& standing_room() const { return standing_; }
  const RoomModel& room() const { return *room_; }
  const PersonReference& reference() const { return reference_; }
  const PersonLocalizerOptions& options() const { return options_; }

 private:
  Expected<Station> make_station(const PersonLink& link) const;
  void build_block(std::size_t block_x, std::size_t block_y);
  ArrayMap whole_map(const PersonHearing::Array& array) const;
  std::vector<double> close_map(const std::vector<ArrayMap>& arrays,
                                std::span<const std::size_t> cells) const;
  double judge(const std::vector<ArrayMap>& arrays,
               std::size_t cell,
               std::size_t sample,
               PersonMap& map) const;

  bool is_transmitter_doubtful(const std::vector<ArrayMap>& arrays,
                               std::size_t cell,
                               std::size_t sample) const;

  std::shared_ptr<const RoomModel> room_;
  PersonReference reference_;
  PersonLocalizerOptions options_;
  StandingRoom standing_;
  std::size_t samples_ = 0;  // along the side of a square
  std::vector<Station> stations_;
};

Expected<Station> PersonLocalizer::Impl::make_station(const PersonLink& link) const {
  if (auto valid = check_link(*room_, link); !valid) {
    return tl::make_unexpected(std::move(valid.error()));
  }
  const RoomAccessPoint& ap = room_->access_points[link.access_point];
  auto scattering = PersonScattering::create(
      *room_, link.access_point, reference_.transmitter, reference_.person.body, options_.depth);
  if (!scattering) {
    return tl::make_unexpected(scattering.error());
  }
  PersonLikelihood likelihood(room_->grid,
                              ap.cores.size(),
                              link,
                              norm(ap.array.pose.position - reference_.transmitter.position));
  Station station{std::move(likelihood), *std::move(scattering), {}, {}, {}};
  station.cells.resize(standing_.grid.size());
  station.nobody = station.likelihood.nobody(reference_.person);
  for (const double share : kChanges) {
    station.changed.push_back(station.likelihood.changed(share, reference_.person));
  }
  return station;
}

// The rays are traced once, in the middle of a block of squares.
void PersonLocalizer::Impl::build_block(std::size_t block_x, std::size_t block_y) {
  const RoomGrid& grid = standing_.grid;
  std::vector<std::size_t> cells;
  for (std::size_t x = block_x; x < std::min(block_x + kBlock, grid.count_x); ++x) {
    for (std::size_t y = block_y; y < std::min(block_y + kBlock, grid.count_y); ++y) {
      if (standing_.free[x * grid.count_y + y] != 0) {
        cells.push_back(x * grid.count_y + y);
      }
    }
  }
  Vec3d middle;
  for (const std::size_t cell : cells) {
    middle = middle + (1.0 / static_cast<double>(cells.size())) * grid.centre(cell);
  }
  for (Station& station : stations_) {
    if (cells.empty()) {
      return;
    }
    const auto rays = station.scattering.at({middle.x, middle.y});
    const auto number = static_cast<std::size_t>(&station - stations_.data());
    for (const std::size_t cell : cells) {
      if (!rays) {  // a device is where the body would be
        standing_.free[cell] = 0;
        continue;
      }
      const Vec3d offset = grid.centre(cell) - middle;
      const PatchPlan plan{offset.x, offset.y, std::max(grid.step_x, grid.step_y), samples_};
      station.cells[cell] = station.likelihood.place(
          station.likelihood.patch(*rays, plan), reference_.links[number].scale, reference_.person);
    }
  }
}

Expected<void> PersonLocalizer::Impl::build() {
  for (const PersonLink& link : reference_.links) {
    auto station = make_station(link);
    if (!station) {
      return tl::make_unexpected(station.error());
    }
    stations_.push_back(*std::move(station));
  }
  const RoomGrid& grid = standing_.grid;
  const double wavelength = kSpeedOfLight / room_->grid.centre_hz;
  samples_ = static_cast<std::size_t>(
      std::ceil(std::max(grid.step_x, grid.step_y) / (kSampleStep * wavelength)));
  const std::size_t blocks_x = (grid.count_x + kBlock - 1) / kBlock;
  const std::size_t blocks_y = (grid.count_y + kBlock - 1) / kBlock;
  parallel_for(blocks_x * blocks_y, 1, [&](std::size_t block) {
    build_block(block / blocks_y * kBlock, block % blocks_y * kBlock);
  });
  return {};
}

PersonHearing PersonLocalizer::Impl::hear(std::span<const CsiFrame> frames) const {
  PersonHearing hearing;
  LocationEstimate& estimate = hearing.estimate;
  estimate.accuracy_confidence = options_.accuracy_confidence;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return hearing;
  }
  HearingTally tally;
  for (std::size_t number = 0; number < stations_.size(); ++number) {
    const Station& station = stations_[number];
    const std::size_t access_point = reference_.links[number].access_point;
    auto burst = rayloc::hear(*room_, access_point, frames, options_.burst, estimate.warnings);
    if (!burst) {
      continue;
    }
    if (const auto dead = dead_chain(*burst)) {
      estimate.warnings.push_back("access point " + room_->access_points[access_point].id +
                                  ": the chain of core " + std::to_string(burst->cores[dead->row]) +
                                  " is dead; the access point is left out");
      continue;
    }
    auto observed = station.likelihood.observe(burst->h);
    // The squares' covariances hold the model's noise only; a burst that has more counts less.
    const double weight = std::min(1.0, reference_.person.noise / observed.noise);
    tally.add(room_->access_points[access_point], *burst);
    hearing.arrays.push_back({number, std::move(observed), weight});
  }
  tally.fill(frames, estimate);
  if (hearing.arrays.empty()) {
    estimate.reason = estimate.warnings.empty() ? "no access point of the reference heard the burst"
                                                : estimate.warnings.front();
  }
  return hearing;
}

ArrayMap PersonLocalizer::Impl::whole_map(const PersonHearing::Array& array) const {
  const Station& station = stations_[array.link];
  const auto likelihood = [&](const WhitenedGaussian& gaussian) {
    return station.likelihood.log_likelihood(gaussian, array.observed);
  };
  ArrayMap map{&array, {}, -std::numeric_limits<double>::infinity(), 0.0};
  for (const WhitenedGaussian& changed : station.changed) {
    map.floor = std::max(map.floor, likelihood(changed) + std::log(kStrange));
  }
  map.nobody = likelihood(station.nobody);
  map.whole.resize(standing_.grid.size());
  parallel_for(map.whole.size(), 32, [&](std::size_t cell) {
    if (standing_.free[cell] != 0) {
      map.whole[cell] = likelihood(station.cells[cell].whole);
    }
  });
  return map;
}

// [cell][sample place], against nobody, all arrays together.
std::vector<double> PersonLocalizer::Impl::close_map(const std::vector<ArrayMap>& arrays,
                                                     std::span<const std::size_t> cells) const {
  const std::size_t places = samples_ * samples_;
  std::vector<double> samples(cells.size() * places);
  parallel_for(cells.size(), 8, [&](std::size_t n) {
    const std::span<double> sum(samples.data() + n * places, places);
    std::vector<double> one(places);
    for (const ArrayMap& map : arrays) {
      const Station& station = stations_[map.array->link];
      station.likelihood.log_likelihood(station.cells[cells[n]], map.array->observed, one);
      for (std::size_t p = 0; p < places; ++p) {
        sum[p] += map.against_nobody(one[p]);
      }
    }
  });
  return samples;
}

// How badly the best place explains the arrays, 1 as expected; notes those that it does not.
double PersonLocalizer::Impl::judge(const std::vector<ArrayMap>& arrays,
                                    std::size_t cell,
                                    std::size_t sample,
                                    PersonMap& map) const {
  double most = 1.0;
  double explained = 0.0;
  std::vector<double> one(samples_ * samples_);
  for (const ArrayMap& of : arrays) {
    const Station& station = stations_[of.array->link];
    const PersonPlace& place = station.cells[cell];
    station.likelihood.log_likelihood(place, of.array->observed, one);
    if (one[sample] < of.floor) {
      map.warnings.push_back(
          "access point " + room_->access_points[reference_.links[of.array->link].access_point].id +
          ": what it hears has changed as one person does not change it");
      continue;
    }
    explained += 1.0;
    most = std::max(
        most, of.array->weight * station.likelihood.misfit(place, sample, of.array->observed));
  }
  map.is_explained = explained > 0.0;
  // Where one access point hears what nobody explains, the others are believed less as well.
  return map.is_explained ? most * static_cast<double>(arrays.size()) / explained : most;
}

// One body stands in one direct way; a transmitter that was moved or covered changes all, and what
// stands right beside it explains that best, for its echoes are strong and not known well.
bool PersonLocalizer::Impl::is_transmitter_doubtful(const std::vector<ArrayMap>& arrays,
                                                    std::size_t cell,
                                                    std::size_t sample) const {
  const Vec3d off = standing_.grid.centre(cell) - reference_.transmitter.position;
  if (std::hypot(off.x, off.y) > kBesideTransmitter) {
    return false;
  }
  const auto strong = std::count_if(arrays.begin(), arrays.end(), [&](const ArrayMap& of) {
    const Station& station = stations_[of.array->link];
    return station.likelihood.echo_power(station.cells[cell], sample) > kStrongEcho;
  });
  return strong > 1;
}

PersonMap PersonLocalizer::Impl::map(const PersonHearing& hearing, double temper) const {
  PersonMap map;
  std::vector<double>& total = map.log_likelihood;
  total.assign(standing_.grid.size(), kNowhere);
  std::vector<ArrayMap> arrays;
  for (const PersonHearing::Array& array : hearing.arrays) {
    arrays.push_back(whole_map(array));
  }
  std::vector<std::size_t> order;
  for (std::size_t cell = 0; cell < total.size(); ++cell) {
    if (standing_.free[cell] != 0) {
      total[cell] = 0.0;
      for (const ArrayMap& one : arrays) {
        total[cell] += one.against_nobody(one.whole[cell]);
      }
      order.push_back(cell);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return total[a] > total[b];
  });
  const double least = total[order.front()] - kCloseMargin / temper;
  std::size_t close = 0;
  while (close < std::min(order.size(), kMostClose) && total[order[close]] >= least) {
    ++close;
  }
  const std::size_t places = samples_ * samples_;
  auto samples = close_map(arrays, {order.data(), close});
  const auto best =
      static_cast<std::size_t>(std::max_element(samples.begin(), samples.end()) - samples.begin());
  // What the best place leaves unexplained is wrong everywhere: count the burst less for it.
  const double exponent = temper / judge(arrays, order[best / places], best % places, map);
  map.is_transmitter_doubtful =
      is_transmitter_doubtful(arrays, order[best / places], best % places);
  for (double& value : samples) {
    value *= exponent;
  }
  for (std::size_t n = 0; n < order.size(); ++n) {
    total[order[n]] = n < close ? log_mean_exp({samples.data() + n * places, places})
                                : exponent * total[order[n]];
  }
  std::vector<double> standing;
  standing.reserve(order.size());
  for (const std::size_t cell : order) {
    standing.push_back(total[cell]);
  }
  map.somebody = log_mean_exp(standing);
  return map;
}

LocationEstimate PersonLocalizer::Impl::locate(std::span<const CsiFrame> frames,
                                               double temper) const {
  PersonHearing hearing = hear(frames);
  LocationEstimate& estimate = hearing.estimate;
  if (hearing.arrays.empty()) {
    return std::move(estimate);
  }
  const PersonMap found = map(hearing, temper);
  estimate.warnings.insert(estimate.warnings.end(), found.warnings.begin(), found.warnings.end());
  if (!found.is_explained) {
    estimate.reason = "the room has changed as no single person would change it";
    return std::move(estimate);
  }
  if (found.is_transmitter_doubtful) {
    estimate.reason =
        "what is heard has changed as by somebody right beside the transmitter; it may have been "
        "moved or covered";
    return std::move(estimate);
  }
  if (found.somebody < kSomebody) {
    estimate.reason = "nobody seen: the room is as it was when it was empty";
    return std::move(estimate);
  }
  summarise_posterior(standing_.grid,
                      found.log_likelihood,
                      {1.0, options_.accuracy_confidence, options_.max_hypotheses, kPersonOutlier},
                      estimate);
  return std::move(estimate);
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
  auto impl = std::make_unique<Impl>(std::move(room), std::move(reference), options);
  if (auto built = impl->build(); !built) {
    return tl::make_unexpected(built.error());
  }
  return PersonLocalizer(std::move(impl));
}

PersonLocalizer::PersonLocalizer(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
PersonLocalizer::~PersonLocalizer() = default;
PersonLocalizer::PersonLocalizer(PersonLocalizer&&) noexcept = default;
PersonLocalizer& PersonLocalizer::operator=(PersonLocalizer&&) noexcept = default;

LocationEstimate PersonLocalizer::locate(std::span<const CsiFrame> frames) const {
  return impl_->locate(frames, impl_->reference().person.temper);
}
LocationEstimate PersonLocalizer::locate(std::span<const CsiFrame> frames, double temper) const {
  return impl_->locate(frames, temper);
}
PersonHearing PersonLocalizer::hear(std::span<const CsiFrame> frames) const {
  return impl_->hear(frames);
}
PersonMap PersonLocalizer::map(const PersonHearing& hearing, double temper) const {
  RAYLOC_CHECK(!hearing.arrays.empty());
  return impl_->map(hearing, temper);
}
const StandingRoom& PersonLocalizer::standing_room() const { return impl_->standing_room(); }
const RoomModel& PersonLocalizer::room() const { return impl_->room(); }
const PersonReference& PersonLocalizer::reference() const { return impl_->reference(); }
const PersonLocalizerOptions& PersonLocalizer::options() const { return impl_->options(); }

}  // namespace rayloc
