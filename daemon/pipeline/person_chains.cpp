#include "daemon/pipeline/person_chains.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "daemon/pipeline/device/chain_texts.h"
#include "engine/chains/chain_frames.h"

namespace rayloc {

PersonChains::PersonChains(const std::string& file, std::shared_ptr<const RoomModel> room)
    : room_(std::move(room)), keeper_({file, ""}), references_(room_) {
  restored_ = keeper_.read(*room_).value_or(std::vector<ChainState>());
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

void PersonChains::apply(const ChainState& state,
                         const MacAddress& transmitter,
                         Usable& result) const {
  const RoomAccessPoint& ap = room_->access_points[state.access_point];
  const std::size_t number = state.access_point;
  const auto links = access_points_.find(transmitter);
  if (state.knowledge == ChainKnowledge::kAsCalibrated || !ap.are_chains_known ||
      links == access_points_.end() || links->second.count(number) == 0) {
    return;
  }
  if (state.knowledge == ChainKnowledge::kLearning) {
    std::erase_if(result.kept, [&](const CsiFrame& frame) { return frame.access_point == number; });
    result.warnings.push_back(learning_warning(state, *room_).text);
    result.reason += (result.reason.empty() ? "" : "; ") + learning_text(state, *room_);
  } else if (references_.contains_factors(transmitter, state.access_point)) {
    result.warnings.push_back(other_reference_text(ap));
  } else {
    undo(state, ap, result.kept);
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
    apply(state, burst.transmitter, result);
  }
  result.frames = result.kept;
  if (!has_link(burst.transmitter, burst.frames) || has_link(burst.transmitter, result.frames)) {
    result.reason.clear();
  }
  return result;
}

}  // namespace rayloc
