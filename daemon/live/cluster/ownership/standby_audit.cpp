#include "daemon/live/cluster/ownership/standby_audit.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "daemon/live/cluster/site_start.h"
#include "daemon/pipeline/output/carried_message.h"

namespace rayloc {
namespace {

constexpr int kOthersInARow = 5;  // a count, chosen: of states, one a second

// Identities and zones of targets: the data that subscribers have on tracks and zones.
std::string names_in(v1::Carried carried) {
  carried.clear_done();
  carried.clear_open();
  carried.clear_heard();
  carried.clear_chains();
  carried.clear_calibration();
  carried.clear_watched();
  for (v1::CarriedPerson& person : *carried.mutable_people()) {
    person.clear_moment();
  }
  for (v1::CarriedOccupant& occupant : *carried.mutable_occupants()) {
    occupant.clear_heard();
    for (v1::CarriedStay& stay : *occupant.mutable_stays()) {
      stay.clear_crossing();
      stay.clear_entered();
      stay.clear_probability();
    }
  }
  return carried.SerializeAsString();
}

std::string words(const v1::OutputItem* item) {
  constexpr std::size_t kMost = 400;  // characters
  const std::string text = item == nullptr ? "nothing" : item->ShortDebugString();
  return text.size() > kMost ? text.substr(0, kMost) + "..." : text;
}

}  // namespace

void StandbyAudit::receive(v1::OutputRecord record) {
  if (record.generation() < options_.generation ||
      (record.generation() == options_.generation && record.number() <= number_)) {
    return;  // from a replaced owner, or repeated
  }
  if (record.generation() > options_.generation) {
    trouble_ = "another worker owns the site since";
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  const bool follows = number_ > 0 && record.number() == number_ + 1;
  counters_.not_compared += number_ > 0 ? record.number() - number_ - 1 : 0;
  number_ = record.number();
  if (record.has_output()) {
    waiting_.push_back({std::move(*record.mutable_output()), follows, now});
  }
  if (!waiting_.empty() && now - waiting_.front().received > options_.most_behind) {
    waiting_.clear();
    trouble_ = "it computes more slowly than the owner";
  }
}

void StandbyAudit::compare(OutItems& own, const std::deque<Carried>& states) {
  while (!waiting_.empty() && time_of_us(waiting_.front().output.done_us()) <= own.done()) {
    const Window window = std::move(waiting_.front());
    waiting_.pop_front();
    const Timestamp done = time_of_us(window.output.done_us());
    const std::vector<v1::OutputItem> computed = own.take_before(done);
    if (window.is_whole) {
      compare_results(window, computed);
    } else {
      ++counters_.not_compared;
    }
    done_ = std::max(done_, done);
    if (window.output.has_carried()) {
      compare_state(window.output.carried(), states);
    }
  }
}

void StandbyAudit::compare_results(const Window& window, const std::vector<v1::OutputItem>& own) {
  const auto wanted = [&](const auto& items) {
    std::vector<std::pair<std::string, const v1::OutputItem*>> all;
    for (const v1::OutputItem& item : items) {
      if (std::string text = compared(item, options_.likeness); !text.empty()) {
        all.emplace_back(std::move(text), &item);
      }
    }
    return all;
  };
  const auto published = wanted(window.output.items());
  const auto found = wanted(own);
  ++counters_.windows;
  counters_.results += published.size();
  std::size_t same = 0;
  while (same < std::min(published.size(), found.size()) &&
         published[same].first == found[same].first) {
    ++same;
  }
  if (same == published.size() && same == found.size()) {
    return;
  }
  ++counters_.differing;
  if (first_difference_.empty()) {
    first_difference_ = fmt::format(
        "the window that ends at {:.6f} s: the owner published '{}', this worker computed '{}'",
        1e-6 * static_cast<double>(window.output.done_us()),
        words(same < published.size() ? published[same].second : nullptr),
        words(same < found.size() ? found[same].second : nullptr));
  }
}

// A state is identified by its instant: it is a function of the frames before.
void StandbyAudit::compare_state(const v1::Carried& theirs, const std::deque<Carried>& states) {
  const auto reported = carried_of(theirs);
  if (!reported) {
    return;  // its reader reports the error
  }
  const auto own = std::find_if(states.rbegin(), states.rend(), [&](const Carried& one) {
    return one.done == reported->done;
  });
  if (own == states.rend()) {
    return;
  }
  // A late standby has a target in a zone a burst earlier or later, and agrees again.
  others_ = names_in(carried_message(*own)) != names_in(theirs) ? others_ + 1 : 0;
  if (others_ >= (options_.likeness == Likeness::kSameBytes ? 1 : kOthersInARow)) {
    trouble_ = "its tracks or stays in zones are others than the owner's";
  }
}

}  // namespace rayloc
