#include "daemon/pipeline/person_numbers.h"

#include <cstddef>
#include <limits>

namespace rayloc {

std::vector<std::uint64_t> numbers_of(std::span<const LocationEstimate> people,
                                      const PersonNumbers& numbers) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; numbers.tracked && i < people.size(); ++i) {
    const double off = people[i].position ? norm(*people[i].position - *numbers.tracked) : least;
    if (off < least) {
      least = off;
      nearest = i;
    }
  }
  std::vector<std::uint64_t> result(people.size(), numbers.first);
  std::uint64_t next = numbers.first;
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (i != nearest) {
      next += numbers.step;
      result[i] = next;
    }
  }
  return result;
}

}  // namespace rayloc
