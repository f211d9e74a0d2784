#include "engine/localize/fix_warnings.h"

#include <cstddef>
#include <string>

namespace rayloc {
namespace {

constexpr double kFaulty = 0.5;            // a probability, chosen
constexpr double kSurelyObstructed = 4.6;  // logarithm of odds of 100, tempered

}  // namespace

// An obstructed line of sight is tested at the fix only: at other places the test is meaningless.
void warn_of_suspects(const std::vector<ArrayObservation>& received,
                      const RoomMap& map,
                      double likelihood_exponent,
                      const RaysOfEach& rays,
                      LocationEstimate& estimate) {
  const std::vector<double> fault_probability = fault_probabilities(map, likelihood_exponent);
  for (std::size_t i = 0; i < received.size(); ++i) {
    const std::string name = "access point " + received[i].map->access_point().id;
    if (received.size() > 1 && fault_probability[i] > kFaulty) {
      estimate.warnings.push_back(name +
                                  " contradicts the others: it is covered, was moved or has "
                                  "changed; its CSI is not used");
      continue;
    }
    const auto odds = received[i].map->obstructed_log_odds(rays[i], received[i].observed);
    if (odds && likelihood_exponent * *odds > kSurelyObstructed) {
      estimate.warnings.push_back(name +
                                  ": the line of sight to the device differs from the plan: it is "
                                  "covered, or the chains have changed");
    }
  }
}

}  // namespace rayloc
