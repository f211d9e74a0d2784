#include "capture/assemble/channel_log.h"

namespace rayloc {

bool ChannelLog::add(const std::optional<RadioChannel>& channel, Timestamp time) {
  if (!channel) {
    return true;
  }
  const bool is_accepted_hop =
      accepts_hops_ && latest_ && is_expected(*latest_) && is_expected(*channel);
  if (latest_ && *latest_ != *channel && !is_accepted_hop) {
    ++changes_;
    if (first_changes_.size() < CsiReceiverCounters::kListedChanges) {
      first_changes_.push_back({time, *latest_, *channel});
    }
  }
  latest_ = channel;
  if (!is_expected(*channel)) {
    return false;
  }
  if (accepts_hops_) {
    ++hops_[*channel];
  }
  return true;
}

bool ChannelLog::is_expected(const RadioChannel& channel) const {
  return !expected_ || is_same_channel(*expected_, channel) ||
         (accepts_hops_ && is_hop(*expected_, channel));
}

std::string ChannelLog::trouble() const {
  if (!latest_ || is_expected(*latest_)) {
    return "";
  }
  return "its datagrams are of the channel at " + to_string(*latest_) + ", the site states " +
         to_string(*expected_);
}

void ChannelLog::report(CsiReceiverCounters& counters) const {
  counters.channel = latest_;
  counters.channel_changes = changes_;
  counters.first_changes = first_changes_;
  counters.hops = hops_;
}

}  // namespace rayloc
