// ComparedEstimator: the estimator of a site whose bursts other methods locate as well. Its results
// are the inner one's, unchanged; the others get each burst once those are published.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "daemon/pipeline/compare/compared_method.h"
#include "daemon/pipeline/pipeline.h"

namespace rayloc {

class ComparedEstimator : public Estimator {
 public:
  // All of them outlive it.
  ComparedEstimator(Estimator& inner, std::span<const std::unique_ptr<ComparedMethod>> others)
      : inner_(inner), others_(others) {}

  void estimate(const Burst& burst, Estimates& out) override { inner_.estimate(burst, out); }
  void estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) override {
    inner_.estimate_each(bursts, out);
  }
  void advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) override {
    inner_.advance(time, is_waiting, out);
    for (const auto& other : others_) {
      other->advance(time);
    }
  }
  void restart(const std::string& reason, Estimates& out) override {
    inner_.restart(reason, out);
    for (const auto& other : others_) {
      other->restart(reason);
    }
  }
  void carry(Carried& carried) const override { inner_.carry(carried); }
  Rank rank(const MacAddress& transmitter) const override { return inner_.rank(transmitter); }
  // A burst is copied for all of them but the last.
  void release(std::vector<Burst>&& bursts) override {
    for (std::size_t i = 0; i < others_.size(); ++i) {
      for (Burst& burst : bursts) {
        if (others_[i]->wants(burst.transmitter)) {
          others_[i]->add(i + 1 == others_.size() ? std::move(burst) : Burst(burst));
        }
      }
    }
    inner_.release(std::move(bursts));
  }

 private:
  Estimator& inner_;
  const std::span<const std::unique_ptr<ComparedMethod>> others_;
};

}  // namespace rayloc
