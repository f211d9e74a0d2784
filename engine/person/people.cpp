#include "engine/person/people.h"

#include <algorithm>
#include <utility>

namespace rayloc {
namespace {

// A count, chosen: one array does not distinguish a pair from one person.
constexpr std::size_t kMinArrays = 2;
// A person explained this well (PersonMap::misfit) is alone: 37 of 38 pairs were not.
constexpr double kExplained = 1.2;
// Places of one person from which a pair is searched for: four find the same pairs as two, in twice
// the time.
constexpr std::size_t kStarts = 2;
constexpr int kTurnsOfEach = 2;  // a count, chosen: moves of each person of a pair

struct Settled {
  std::array<PersonSample, 2> places;
  double log_likelihood = 0.0;
};

// Refines both places in turn, near their present ones.
Settled settle(const PersonLocalizer& localizer,
               const PersonObservation& observation,
               double likelihood_exponent,
               Settled pair) {
  for (int turn = 0; turn < 2 * kTurnsOfEach; ++turn) {
    PersonSample& one = pair.places[static_cast<std::size_t>(turn) % 2];
    const std::array others = {pair.places[static_cast<std::size_t>(turn + 1) % 2]};
    const PersonMap map = localizer.map(observation, likelihood_exponent, {others, one});
    if (map.places.empty() || !(map.best_log_likelihood > pair.log_likelihood)) {
      break;
    }
    pair.log_likelihood = map.best_log_likelihood;
    one = map.places.front();
  }
  return pair;
}

}  // namespace

std::optional<PersonPair> best_pair(const PersonLocalizer& localizer,
                                    const PersonObservation& observation,
                                    double likelihood_exponent,
                                    const PersonMap& alone) {
  if (observation.arrays.size() < kMinArrays || alone.misfit < kExplained) {
    return std::nullopt;
  }
  std::optional<PersonPair> best;
  for (std::size_t i = 0; i < std::min(kStarts, alone.places.size()); ++i) {
    const std::array others = {alone.places[i]};
    const PersonMap other = localizer.map(observation, likelihood_exponent, {others, std::nullopt});
    if (other.places.empty()) {
      continue;
    }
    const Settled pair = settle(localizer,
                                observation,
                                likelihood_exponent,
                                {{others[0], other.places.front()}, other.best_log_likelihood});
    const double gain = pair.log_likelihood - alone.best_log_likelihood;
    if (!best || gain > best->gain) {
      best = PersonPair{pair.places, gain};
    }
  }
  return best;
}

std::vector<PersonMap> map_people(const PersonLocalizer& localizer,
                                  const PersonObservation& observation) {
  const PersonModel& person = localizer.reference().person;
  PersonMap alone = localizer.map(observation, person.likelihood_exponent);
  const auto pair = person.second_person
                        ? best_pair(localizer, observation, person.likelihood_exponent, alone)
                        : std::nullopt;
  if (!pair || pair->gain <= *person.second_person) {
    return {std::move(alone)};
  }
  std::vector<PersonMap> both;
  for (const std::size_t i : {0U, 1U}) {
    const std::array others = {pair->places[1 - i]};
    both.push_back(localizer.map(observation, person.likelihood_exponent, {others, std::nullopt}));
    if (!both.back().is_explained || both.back().presence < 0.0) {  // less likely than not
      return {std::move(alone)};
    }
  }
  return both;
}

std::vector<LocationEstimate> locate_people(const PersonLocalizer& localizer,
                                            std::span<const CsiFrame> frames) {
  PersonObservation observation = localizer.receive(frames);
  if (observation.arrays.empty()) {
    return {std::move(observation.estimate)};
  }
  std::vector<LocationEstimate> estimates;
  for (const PersonMap& map : map_people(localizer, observation)) {
    estimates.push_back(localizer.summarise(observation.estimate, map));
  }
  return estimates;
}

}  // namespace rayloc
