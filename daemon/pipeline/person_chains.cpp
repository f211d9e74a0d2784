#include "daemon/pipeline/person_chains.h"

#include <algorithm>
#include <complex>
#include <cstddef>
#include <utility>

#include "daemon/pipeline/device/chain_file.h"
#include "daemon/pipeline/device/chain_texts.h"
#include "engine/chains/chain_frames.h"

namespace rayloc {

PersonChains::PersonChains(const std::string& file, std::shared_ptr<const RoomModel> room)
    : room_(std::move(room)), file_(file), references_(room_) {
  if (file.empty()) {
    return;
  }
  auto states = read_chain_file(file, *room_);
  if (!states) {
    notices_.push_back(states.error().message);
    return;
  }
  restored_ = *std::move(states);
  for (const ChainState& state : restored_) {
    notices_.push_back("access point " + room_->access_points[state.access_point].id + ": " +
                       (state.knowledge == ChainKnowledge::kLearned
                            ? "its chains are as learned before: " + rotations_text(state, *room_)
                            : unlearned_text()));
  }
}

// The state is that of the file, from which nothing is learned here.
std::string PersonChains::unlearned_text() const {
  return "its chains were not learned when " + file_ + " was written";
}

void PersonChains::add(const PersonReference& reference) {
  for (const PersonLink& link : reference.links) {
    if (!check_link(*room_, link)) {
      continue;
    }
    references_.add(reference.mac, link.access_point, link.empty);
    access_points_[reference.mac].insert(link.access_point);
  }
}

bool PersonChains::has_link(const MacAddress& transmitter, std::span<const CsiFrame> frames) const {
  const auto found = access_points_.find(transmitter);
  return found != access_points_.end() &&
         std::any_of(frames.begin(), frames.end(), [&](const CsiFrame& frame) {
           return found->second.count(frame.access_point) != 0;
         });
}

void PersonChains::leave_out(const ChainState& state, bool is_of_file, Usable& result) const {
  const std::size_t number = state.access_point;
  std::erase_if(result.kept, [&](const CsiFrame& frame) { return frame.access_point == number; });
  const std::string& id = room_->access_points[number].id;
  result.warnings.push_back(is_of_file ? "chain_phase_jump: access point " + id + ": " +
                                             unlearned_text() + "; its CSI is not used"
                                       : learning_warning(state, *room_).text);
  result.reason +=
      (result.reason.empty() ? "" : "; ") +
      (is_of_file ? "access point " + id + ": " + unlearned_text() : learning_text(state, *room_));
}

void PersonChains::apply(const ChainState& state,
                         const MacAddress& transmitter,
                         bool is_of_file,
                         Usable& result) const {
  const RoomAccessPoint& ap = room_->access_points[state.access_point];
  const std::size_t number = state.access_point;
  const auto links = access_points_.find(transmitter);
  if (state.knowledge == ChainKnowledge::kAsCalibrated || !ap.are_chains_known ||
      links == access_points_.end() || links->second.count(number) == 0) {
    return;
  }
  if (state.knowledge == ChainKnowledge::kLearning) {
    leave_out(state, is_of_file, result);
    return;
  }
  undo(state, ap, result.kept);
  const std::vector<std::complex<double>> recorded = references_.presumed(transmitter, number);
  if (recorded.empty()) {
    return;
  }
  result.warnings.push_back(other_reference_text(ap));
  for (CsiFrame& frame : result.kept) {
    if (frame.access_point == number) {
      multiply(ap, recorded, frame);
    }
  }
}

PersonChains::Usable PersonChains::usable(const Burst& burst,
                                          const std::vector<ChainState>* states) {
  const std::vector<ChainState>& all = states != nullptr ? *states : restored_;
  Usable result;
  result.frames = burst.frames;
  if (std::all_of(all.begin(), all.end(), [](const ChainState& state) {
        return state.knowledge == ChainKnowledge::kAsCalibrated;
      })) {
    return result;
  }
  references_.observe(burst.transmitter, burst.frames, all);
  result.kept = burst.frames;
  for (const ChainState& state : all) {
    apply(state, burst.transmitter, states == nullptr, result);
  }
  result.frames = result.kept;
  if (!has_link(burst.transmitter, burst.frames) || has_link(burst.transmitter, result.frames)) {
    result.reason.clear();
  }
  return result;
}

}  // namespace rayloc
