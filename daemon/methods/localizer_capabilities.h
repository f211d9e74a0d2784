// The capabilities of a method that compares the channel with a Localizer's room.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "daemon/methods/device_capabilities.h"
#include "engine/chains/chain_learner.h"
#include "engine/chains/coarse_fix.h"
#include "engine/localize/localizer.h"

namespace rayloc {

// REQUIRES: ChainLearner::learns_from() the localizer's likelihood, for receive() and the members
// that use its results.
class LocalizerChains final : public ChainCapability {
 public:
  explicit LocalizerChains(std::shared_ptr<const Localizer> localizer)
      : localizer_(std::move(localizer)), learner_(localizer_) {}

  void receive(std::span<const CsiFrame> frames) override { learner_.receive(frames); }
  void receive_at(const Vec3d& place, std::span<const CsiFrame> frames) override {
    learner_.receive(frames, place);
  }

  std::vector<CsiFrame> accepted(std::span<const CsiFrame> frames) const override {
    return learner_.accepted(frames);
  }
  std::vector<CsiFrame> undone(std::span<const CsiFrame> frames) const override {
    return learner_.undone(frames);
  }
  bool leaves_alone() const override { return learner_.leaves_alone(); }
  ChainTrust trust(std::span<const CsiFrame> accepted) const override {
    return {learner_.fault_of(accepted), learner_.withdrawals()};
  }
  LocationEstimate locate_coarsely(std::span<const CsiFrame> frames) const override {
    return rayloc::locate_coarsely(
        *localizer_, learner_.undone(frames), learner_.beliefs_before(frames));
  }

  std::vector<ChainState> states() const override { return learner_.states(); }
  std::optional<ChainRecord> record(std::size_t access_point) const override {
    return learner_.record(access_point);
  }
  std::uint64_t changes() const override { return learner_.changes(); }
  void adopt(const ChainState& state) override { learner_.adopt(state); }
  void restore(const ChainState& state) override { learner_.restore(state); }
  void power_cycled(std::size_t access_point, Timestamp time) override {
    learner_.power_cycled(access_point, time);
  }
  void restart() override { learner_.restart(); }

  std::uint64_t withdrawals() const { return learner_.withdrawals(); }

 private:
  std::shared_ptr<const Localizer> localizer_;
  ChainLearner learner_;
};

class LocalizerChannel final : public ChannelCapability {
 public:
  explicit LocalizerChannel(std::shared_ptr<const Localizer> localizer)
      : localizer_(std::move(localizer)) {}

  const RoomModel& room() const override { return localizer_->room(); }
  RoomObservation receive(std::span<const CsiFrame> frames) const override {
    return localizer_->receive(frames);
  }

 private:
  std::shared_ptr<const Localizer> localizer_;
};

}  // namespace rayloc
