#include "daemon/live/cluster/ownership/out_items.h"

#include <algorithm>
#include <utility>

#include "daemon/live/cluster/site_start.h"
#include "daemon/messages/location_message.h"
#include "daemon/messages/topic.h"

namespace rayloc {
namespace {

constexpr std::size_t kItemHead = 6;  // bytes: its field and its length in a record

struct MessageOf {
  v1::OutputItem operator()(const Location& location) const {
    v1::OutputItem item;
    *item.mutable_location() = location_message(location);
    return item;
  }
  v1::OutputItem operator()(const TrackEvent& event) const {
    v1::OutputItem item;
    *item.mutable_track() = event_message(event);
    return item;
  }
  v1::OutputItem operator()(const ZoneEvent& event) const {
    v1::OutputItem item;
    *item.mutable_zone() = event_message(event);
    return item;
  }
};

struct KeyOf {
  std::tuple<Timestamp, std::string, std::size_t> operator()(const Location& location) const {
    return {
        location.estimate.time, target_component(location.target), location.is_filtered() ? 1 : 0};
  }
  std::tuple<Timestamp, std::string, std::size_t> operator()(const TrackEvent& event) const {
    return {event.transition.time, target_component(event.target), 2};
  }
  std::tuple<Timestamp, std::string, std::size_t> operator()(const ZoneEvent& event) const {
    return {event.time, target_component(event.target), 3};
  }
};

struct InstantOf {
  std::int64_t operator()(const Location& location) const { return us_of(location.estimate.time); }
  std::int64_t operator()(const TrackEvent& event) const { return us_of(event.transition.time); }
  std::int64_t operator()(const ZoneEvent& event) const { return us_of(event.time); }
};

}  // namespace

void OutItems::add(Item&& item) {
  Key key = std::visit(KeyOf{}, item);
  if (std::get<Timestamp>(key) >= from_) {
    held_.emplace(std::move(key), std::move(item));
  }
}

bool OutItems::advance(Timestamp time) {
  const Timestamp done = time_of_us(us_of(time));
  if (done <= done_) {
    return false;
  }
  done_ = done;
  const auto end = held_.lower_bound(Key{done, "", 0});
  for (auto item = held_.begin(); item != end; ++item) {
    ready_.push_back(std::move(item->second));
  }
  held_.erase(held_.begin(), end);
  return true;
}

OutItems::Part OutItems::take(std::size_t most) {
  Part part;
  std::size_t bytes = 0;
  while (!ready_.empty()) {
    const std::int64_t instant = std::visit(InstantOf{}, ready_.front());
    std::vector<v1::OutputItem> messages;
    std::size_t all = 0;  // for this instant
    for (auto item = ready_.begin();
         item != ready_.end() && std::visit(InstantOf{}, *item) == instant;
         ++item) {
      messages.push_back(std::visit(MessageOf{}, *item));
      all += messages.back().ByteSizeLong() + kItemHead;
    }
    if (bytes > 0 && bytes + all > most) {
      part.output.set_done_us(instant);
      return part;
    }
    for (v1::OutputItem& message : messages) {
      const std::size_t size = message.ByteSizeLong() + kItemHead;
      if (bytes + size <= most) {
        bytes += size;
        part.items.push_back(std::move(ready_.front()));
        *part.output.add_items() = std::move(message);
      } else {
        ++part.left_out;
      }
      ready_.pop_front();
    }
  }
  part.output.set_done_us(us_of(done_));
  return part;
}

std::vector<v1::OutputItem> OutItems::take_before(Timestamp time) {
  std::vector<v1::OutputItem> messages;
  while (!ready_.empty() && std::get<Timestamp>(std::visit(KeyOf{}, ready_.front())) < time) {
    messages.push_back(std::visit(MessageOf{}, ready_.front()));
    ready_.pop_front();
  }
  return messages;
}

void OutItems::begin_at(Timestamp time) {
  from_ = std::max(from_, time);
  done_ = std::max(done_, time);
  held_.erase(held_.begin(), held_.lower_bound(Key{time, "", 0}));
  std::erase_if(ready_, [&](const Item& item) {
    return std::get<Timestamp>(std::visit(KeyOf{}, item)) < time;
  });
}

}  // namespace rayloc
