// EstimatorList: several estimators as one; each processes the bursts of its transmitters.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/pipeline.h"

namespace rayloc {

class EstimatorList : public Estimator {
 public:
  // Estimators are called in the order in which they were added, and outlive the list.
  void add(Estimator& estimator) { estimators_.push_back(&estimator); }

  void estimate(const Burst& burst, Estimates& out) override {
    estimate_each({&burst, 1}, {&out, 1});
  }
  void estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) override {
    for (Estimator* estimator : estimators_) {
      estimator->estimate_each(bursts, out);
    }
  }
  void advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) override {
    for (Estimator* estimator : estimators_) {
      estimator->advance(time, is_waiting, out);
    }
  }
  void restart(const std::string& reason, Estimates& out) override {
    for (Estimator* estimator : estimators_) {
      estimator->restart(reason, out);
    }
  }
  void carry(Carried& carried) const override {
    for (const Estimator* estimator : estimators_) {
      estimator->carry(carried);
    }
  }
  Rank rank(const MacAddress& transmitter) const override {
    Rank first = Rank::kOther;
    for (const Estimator* estimator : estimators_) {
      first = std::min(first, estimator->rank(transmitter));
    }
    return first;
  }

 private:
  std::vector<Estimator*> estimators_;
};

}  // namespace rayloc
