#include "daemon/live/cluster/numbered_ring.h"

#include <algorithm>
#include <utility>

namespace rayloc {
namespace {

constexpr const char* kAbsent = "the broker was absent";
constexpr const char* kNotKept = "no longer kept";
// Number of batches whose contents are remembered: an hour of 20 a second.
constexpr std::size_t kMaxRemembered = 72'000;
// Batches per request: further ones need another request.
constexpr std::uint64_t kMaxRequested = 4096;

bool covers(const std::vector<BatchGap>& gaps, std::uint64_t number) {
  return std::any_of(gaps.begin(), gaps.end(), [number](const BatchGap& gap) {
    return gap.from <= number && number <= gap.to;
  });
}

void move(const NumberedRing::Counts& counts,
          NumberedRing::Counts& from,
          NumberedRing::Counts& to) {
  for (const auto& [access_point, count] : counts) {
    from[access_point] -= count;
    to[access_point] += count;
  }
}

}  // namespace

std::map<std::string, std::uint64_t> counts_of(const Batch& batch) {
  std::map<std::string, std::uint64_t> counts;
  for (const BatchPart& part : batch.parts) {
    if (!part.datagrams.entries.empty()) {
      counts[part.access_point] += part.datagrams.entries.size();
    }
  }
  return counts;
}

void NumberedRing::add(Batch batch, Time now) {
  Entry entry;
  entry.added = now;
  entry.counts = counts_of(batch);
  entry.batch = std::move(batch);
  for (const auto& [access_point, count] : entry.counts) {
    counters_.added[access_point] += count;
    counters_.waiting[access_point] += count;
  }
  ++last_;
  ++counters_.batches;
  unsent_.insert(last_);
  entries_.emplace(last_, std::move(entry));
}

void NumberedRing::tend(Time now) {
  while (!unsent_.empty()) {
    const auto oldest = entries_.find(*unsent_.begin());
    if (now - oldest->second.added < limits_.stale) {
      break;
    }
    unsent_.erase(unsent_.begin());
    const std::uint64_t number = oldest->first;
    Counts counts = std::move(oldest->second.counts);
    left_out_.push_back(std::move(oldest->second.batch));
    left_out_.back().epoch = epoch_;
    left_out_.back().number = number;
    entries_.erase(oldest);
    mark(number, counters_.waiting, {std::move(counts), {}}, kAbsent);
  }
  for (auto at = entries_.begin(); at != entries_.end();) {
    const auto entry = at++;
    if (entry->second.state != State::kAcknowledged) {
      continue;
    }
    if (kept_bytes_ - window_ <= limits_.keep_bytes && now - entry->second.added < limits_.keep) {
      break;
    }
    forget(entry);
  }
}

void NumberedRing::forget(Entries::iterator at) {
  Entry& entry = at->second;
  kept_bytes_ -= entry.bytes->size();
  asked_.erase(at->first);
  remembered_[at->first] = {std::move(entry.counts), std::move(entry.gaps)};
  entries_.erase(at);
  if (remembered_.size() > kMaxRemembered) {
    remembered_.erase(remembered_.begin());
  }
}

std::optional<NumberedRing::Ready> NumberedRing::next(Time now) {
  if (!in_flight_.empty() && now - in_flight_.begin()->first >= limits_.patience) {
    ++counters_.repeated;
    return send(entries_.find(in_flight_.begin()->second), now);
  }
  if (!asked_.empty()) {
    const auto entry = entries_.find(*asked_.begin());
    asked_.erase(asked_.begin());
    ++counters_.asked_for;
    ++entry->second.repeat;
    return send(entry, now);
  }
  if (unsent_.empty() || window_ >= limits_.window_bytes) {
    return std::nullopt;
  }
  return send(entries_.find(*unsent_.begin()), now);
}

NumberedRing::Ready NumberedRing::send(Entries::iterator at, Time now) {
  Entry& entry = at->second;
  if (!entry.bytes) {
    Batch& batch = entry.batch;
    batch.epoch = epoch_;
    batch.number = at->first;
    batch.gaps = std::exchange(marks_, {});
    batch.oldest_kept = entries_.begin()->first;
    entry.bytes = std::make_shared<const std::string>(encode(batch));
    kept_bytes_ += entry.bytes->size();
    entry.gaps = std::move(batch.gaps);
    batch = {};
  }
  if (entry.state == State::kInFlight) {
    in_flight_.erase({entry.sent, at->first});
  } else {
    window_ += entry.bytes->size();
    if (entry.state == State::kAcknowledged) {
      move(entry.counts, counters_.live, counters_.waiting);
    }
  }
  unsent_.erase(at->first);
  entry.state = State::kInFlight;
  entry.sent = now;
  in_flight_.insert({now, at->first});
  ++counters_.sent;
  return {at->first, entry.repeat, entry.bytes};
}

// Its number is used and may have reached the broker, so it stays unchanged.
void NumberedRing::not_sent(std::uint64_t number) {
  const auto at = entries_.find(number);
  if (at == entries_.end() || at->second.state != State::kInFlight) {
    return;
  }
  --counters_.sent;
  in_flight_.erase({at->second.sent, number});
  at->second.sent = at->second.added;
  in_flight_.insert({at->second.sent, number});
}

void NumberedRing::acknowledged(std::uint64_t number) {
  const auto at = entries_.find(number);
  if (at == entries_.end() || at->second.state != State::kInFlight) {
    return;
  }
  Entry& entry = at->second;
  in_flight_.erase({entry.sent, number});
  window_ -= entry.bytes->size();
  entry.state = State::kAcknowledged;
  move(entry.counts, counters_.waiting, counters_.live);
}

void NumberedRing::consumed(std::uint64_t number) {
  remembered_.erase(remembered_.begin(), remembered_.upper_bound(number));
  while (!entries_.empty() && entries_.begin()->first <= number) {
    const auto oldest = entries_.begin();
    acknowledged(oldest->first);  // a consumed batch came from the broker
    if (oldest->second.state != State::kAcknowledged) {
      return;  // an unsent batch cannot be consumed
    }
    asked_.erase(oldest->first);
    kept_bytes_ -= oldest->second.bytes->size();
    entries_.erase(oldest);
  }
}

bool NumberedRing::is_marked(std::uint64_t number) const {
  const auto has_number = [number](const auto& batch) { return covers(batch.second.gaps, number); };
  return covers(marks_, number) || std::any_of(entries_.begin(), entries_.end(), has_number) ||
         std::any_of(remembered_.begin(), remembered_.end(), has_number);
}

void NumberedRing::ask(std::uint64_t from, std::uint64_t to) {
  from = std::max<std::uint64_t>(from, 1);
  to = std::min({to, last_, from + kMaxRequested - 1});
  for (std::uint64_t number = from; number <= to; ++number) {
    if (const auto at = entries_.find(number); at != entries_.end()) {
      if (at->second.state == State::kAcknowledged) {
        asked_.insert(number);
      }
    } else if (const auto known = remembered_.find(number); known != remembered_.end()) {
      Remembered batch = std::move(known->second);
      remembered_.erase(known);
      mark(number, counters_.live, std::move(batch), kNotKept);
    } else if (!is_marked(number)) {
      add_mark({number, number, {}, kNotKept});
    }
  }
}

// Replaces the batch by a mark, and restores the marks in it. `of`: the counts that included it.
void NumberedRing::mark(std::uint64_t number,
                        Counts& of,
                        Remembered batch,
                        const std::string& reason) {
  ++counters_.marked_batches;
  move(batch.counts, of, counters_.marked);
  for (BatchGap& gap : batch.gaps) {
    add_mark(std::move(gap));
  }
  add_mark({number, number, std::move(batch.counts), reason});
}

// Merges consecutive marks of batches that were never sent. Other marked
// batches may still arrive, and the reader counts each of them separately.
void NumberedRing::add_mark(BatchGap gap) {
  const auto behind = std::find_if(
      marks_.begin(), marks_.end(), [&](const BatchGap& one) { return one.from > gap.to; });
  if (behind != marks_.begin()) {
    BatchGap& before = *std::prev(behind);
    if (before.to + 1 == gap.from && gap.reason == kAbsent && before.reason == kAbsent) {
      before.to = gap.to;
      for (const auto& [access_point, count] : gap.datagrams) {
        before.datagrams[access_point] += count;
      }
      return;
    }
  }
  marks_.insert(behind, std::move(gap));
}

NumberedRing::Counters NumberedRing::counters() const {
  Counters counters = counters_;
  counters.unacknowledged = unsent_.size() + in_flight_.size();
  counters.kept = entries_.size() - unsent_.size();
  counters.kept_bytes = kept_bytes_;
  return counters;
}

}  // namespace rayloc
