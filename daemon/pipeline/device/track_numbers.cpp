#include "daemon/pipeline/device/track_numbers.h"

#include <algorithm>
#include <chrono>
#include <iterator>

namespace rayloc {
namespace {

// Chosen: a track that is not continued for so long had ended: twice the silence after which any
// track is lost (TrackOptions::lose_after).
constexpr Duration kGivenUp = std::chrono::seconds(10);

}  // namespace

std::uint64_t TrackNumbers::take(const std::string& target) {
  const auto found =
      std::find_if(before_.begin(), before_.end(), [&](const NumberedTracks::Track& one) {
        return one.target == target;
      });
  if (found == before_.end()) {
    return ++last_;
  }
  const std::uint64_t number = found->number;
  before_.erase(found);
  return number;
}

std::uint64_t TrackNumbers::of(const MacAddress& device,
                               const std::string& target,
                               Timestamp time) {
  if (time < done_) {
    const auto found = std::find_if(
        before_.begin(), before_.end(), [&](const auto& one) { return one.target == target; });
    return found == before_.end() ? 0 : found->number;
  }
  std::vector<Numbered>& all = tracks_[device];
  if (!all.empty() && !all.back().lost) {
    if (all.back().track.target == target) {
      return all.back().track.number;
    }
    all.back().lost = time;
  }
  const std::uint64_t number = take(target);
  all.push_back({{target, number}, std::nullopt});
  return number;
}

void TrackNumbers::lost(const MacAddress& device, Timestamp time) {
  const auto found = tracks_.find(device);
  if (found != tracks_.end() && !found->second.empty() && !found->second.back().lost) {
    found->second.back().lost = time;
  }
}

void TrackNumbers::advance(Timestamp done) {
  for (auto it = tracks_.begin(); it != tracks_.end();) {
    std::erase_if(it->second,
                  [&](const Numbered& track) { return track.lost && *track.lost < done; });
    it = it->second.empty() ? tracks_.erase(it) : std::next(it);
  }
  if (!before_.empty() && done > done_ && done - done_ > kGivenUp) {
    before_.clear();
  }
}

NumberedTracks TrackNumbers::carried() const {
  NumberedTracks carried{last_, {}};
  for (const auto& [device, all] : tracks_) {
    for (const Numbered& one : all) {
      carried.tracks.push_back(one.track);
    }
  }
  carried.tracks.insert(carried.tracks.end(), before_.begin(), before_.end());
  return carried;
}

}  // namespace rayloc
