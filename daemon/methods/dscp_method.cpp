// The row `dscp`: images of amplitude differences, compared by a network with those of a person at
// known places. It has no tracks.
#include <memory>
#include <string>
#include <utility>

#include "daemon/methods/method.h"
#include "daemon/methods/person_method.h"
#include "engine/baselines/dscp/dscp.h"

namespace rayloc {
namespace {

class DscpPeople : public PersonMethod {
 public:
  DscpPeople(PlaceClassifier classifier, bool has_empty_room, std::string problem)
      : classifier_(std::make_unique<PlaceClassifier>(std::move(classifier))),
        has_empty_room_(has_empty_room),
        problem_(std::move(problem)) {}

  std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                       std::uint64_t repeat) const override {
    LocationEstimate estimate = classifier_->locate(frames, repeat);
    if (!problem_.empty()) {
      estimate.position.reset();
      estimate.hypotheses.clear();
      estimate.residual_probability = 1.0;
      estimate.reason = problem_;
    }
    if (estimate.position) {
      estimate.position->z = 0.0;  // positions of people are on the floor
      if (!has_empty_room_) {
        estimate.warnings.emplace_back(
            "dscp was trained without --empty: it always detects a person");
      }
    }
    return {std::move(estimate)};
  }

 private:
  std::unique_ptr<PlaceClassifier> classifier_;
  bool has_empty_room_;
  std::string problem_;
};

Expected<std::unique_ptr<PersonMethod>> create_person(PersonMethodInput input) {
  const std::shared_ptr<const Training> training = input.training;
  auto made = make_dscp(std::move(input.room),
                        input.options.values,
                        input.options.seed,
                        input.options.accuracy_confidence,
                        training);
  RAYLOC_TRY(made);
  std::string problem;
  if (training->transmitter && *training->transmitter != input.reference.mac) {
    problem = "dscp was trained with " + to_string(*training->transmitter) + " as the sender";
  }
  return std::make_unique<DscpPeople>(
      *std::move(made), training->network->has_empty_room, std::move(problem));
}

}  // namespace

const Method& dscp_method() {
  static const Method kRow = {
      .name = "dscp",
      .summary = "a network trained on images of amplitudes with a person at known places",
      .reference = "DSCP, WCMC 2021",
      .domain = "chain gains; people at known places",
      .baseline_settings = dscp_settings(),
      .create_person = &create_person,
      .train = &train_dscp,
      .needs_training = true};
  return kRow;
}

}  // namespace rayloc
