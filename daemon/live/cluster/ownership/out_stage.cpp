#include "daemon/live/cluster/ownership/out_stage.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "daemon/pipeline/output/carried_message.h"
#include "daemon/pipeline/warm/warm_start.h"

namespace rayloc {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTryAgain{100};  // for records that the broker has not taken
// Time limit for the broker at the end.
constexpr std::chrono::seconds kOutFinishTimeout{2};
// States that a standby keeps, about one a second, before it checks which are still needed.
constexpr std::size_t kStatesKept = 32;
constexpr std::size_t kMaxStates =
    600;  // a count, chosen: some minutes without a record of the owner

// Converts the carried state of the predecessor to records.
std::deque<Carried> records_of(const SiteStart& start) {
  if (!start.carried) {
    return {};
  }
  Carried listened = *start.carried;  // where its input begins
  listened.done = listened.received = std::min(listened.open.at, listened.done);
  return {std::move(listened), *start.carried};
}

}  // namespace

OutStage::OutStage(std::unique_ptr<OwnerLog> log, LocationSink& inner, Options options)
    : log_(std::move(log)),
      inner_(inner),
      options_(std::move(options)),
      items_(log_->start().from),
      records_(records_of(log_->start())) {}

OutStage::OutStage(const SiteStart& start,
                   LocationSink& inner,
                   Options options,
                   const StandbyAudit::Options& audit)
    : inner_(inner),
      options_(std::move(options)),
      items_(start.from),
      records_(records_of(start)),
      audit_(std::make_unique<StandbyAudit>(audit)) {}

OutStage::~OutStage() {
  end("it has ended");
  if (thread_.joinable()) {
    thread_.join();
  }
}

void OutStage::start() {
  thread_ = std::thread([this] { run(); });
}

void OutStage::hold(Item&& item) {
  const std::lock_guard lock(mutex_);
  if (!closed_) {
    items_.add(std::move(item));
  }
}

void OutStage::location(Location&& location) { hold(std::move(location)); }

void OutStage::event(TrackEvent&& event) { hold(std::move(event)); }

void OutStage::event(ZoneEvent&& event) { hold(std::move(event)); }

void OutStage::advance(Timestamp time) {
  if (options_.progress) {
    options_.progress(time);
  }
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || !items_.advance(time)) {
      return;
    }
    if (audit_) {
      compare();
      return;
    }
    if (items_.ready() == 0) {
      return;
    }
  }
  wake_.notify_one();
}

void OutStage::carried(Carried&& carried) {
  const std::lock_guard lock(mutex_);
  if (!closed_) {
    records_.push_back(std::move(carried));
  }
}

void OutStage::receive(v1::OutputRecord&& record) {
  const std::lock_guard lock(mutex_);
  if (audit_ && !closed_) {
    audit_->receive(std::move(record));
    compare();
  }
}

// REQUIRES: the mutex is held, and this is a standby.
void OutStage::compare() {
  audit_->compare(items_, records_);
  closed_ = closed_ || !audit_->trouble().empty() || items_.ready() > options_.most_waiting ||
            records_.size() > kMaxStates;
  if (records_.size() > prune_at_) {
    const std::vector<Carried> records(records_.begin(), records_.end());
    if (const auto start = warm_start(records, audit_->done(), options_.warm_up)) {
      forget_before(start->open.at);
      (void)options_.resume(start->listen_from);  // the feed drops its places too
    }
    prune_at_ = records_.size() + kStatesKept;  // the copy for that is large
  }
}

std::optional<OutStage::Standby> OutStage::standby() const {
  const std::lock_guard lock(mutex_);
  if (!audit_) {
    return std::nullopt;
  }
  return Standby{audit_->counters(), audit_->first_difference(), closed_ ? trouble() : ""};
}

// REQUIRES: the mutex is held, and this is a standby.
std::string OutStage::trouble() const {
  return audit_->trouble().empty() ? "the owner has published nothing for too long"
                                   : audit_->trouble();
}

Timestamp OutStage::gone_before() const {
  const std::lock_guard lock(mutex_);
  return audit_ ? audit_->done() : Timestamp::min();
}

void OutStage::promote(std::unique_ptr<OwnerLog> log) {
  {
    const std::lock_guard lock(mutex_);
    log_ = std::move(log);
    if (closed_ && ended_.empty()) {  // since the check for promotion: the next check reports it
      ended_ = trouble();
    }
    audit_.reset();
    items_.begin_at(log_->start().from);
  }
  start();
}

void OutStage::run() {
  pthread_setname_np(pthread_self(), "results");  // for top -H
  while (wait_for_something()) {
    OutItems::Part part = next_part();
    if (!append(part.output)) {
      break;
    }
    const bool released = part.output.released();
    pass_on(std::move(part));
    if (released) {
      end("it was given back");
    }
  }
  progress_.rest();
}

// Returns false when it has ended.
bool OutStage::wait_for_something() {
  std::unique_lock lock(mutex_);
  progress_.rest();
  wake_.wait_until(lock, written_ + options_.every, [&] { return finishing_ || !ended_.empty(); });
  wake_.wait_until(lock, written_ + options_.at_most, [&] {
    return finishing_ || !ended_.empty() || items_.ready() > 0;
  });
  progress_.beat();
  return ended_.empty();
}

// REQUIRES: the mutex is held. The next owner of the site reads its stream again.
void OutStage::give_up_where_too_much_waits() {
  if (items_.ready() > options_.most_waiting && ended_.empty()) {
    ended_ = "the broker takes no results";
    closed_ = true;
  }
}

OutItems::Part OutStage::next_part() {
  const std::size_t most = log_->most_items();
  const std::lock_guard lock(mutex_);
  OutItems::Part part = items_.take(most);
  part.output.set_released(finishing_ && items_.ready() == 0);
  add_successor(time_of_us(part.output.done_us()), part.output);
  return part;
}

// REQUIRES: the mutex is held. A start without a state is a cold one: it reads everything.
void OutStage::add_successor(Timestamp done, v1::SiteOutput& output) {
  Timestamp listen_from = Timestamp::min();
  const std::vector<Carried> records(records_.begin(), records_.end());
  if (!records.empty()) {
    if (auto start = warm_start(records, done, options_.warm_up); start && start->carried) {
      listen_from = start->listen_from;
      Carried carried = *start->carried;
      carried.open = listen_from == Timestamp::min() ? records.front().open : start->open;
      *output.mutable_carried() = carried_message(carried);
      forget_before(start->open.at);
    }
  }
  *output.mutable_resume() = position_message(options_.resume(listen_from));
  output.set_resume_us(us_of(listen_from));
}

// REQUIRES: the mutex is held. States before the first one that is read again are not needed.
void OutStage::forget_before(Timestamp open) {
  while (records_.size() > 2 && records_[1].open.at <= open) {
    records_.pop_front();
  }
}

// Returns false if another worker owns the site, or if it has ended.
bool OutStage::append(const v1::SiteOutput& output) {
  for (;;) {
    progress_.beat();
    const OwnerLog::Outcome outcome = log_->append(output);
    written_ = std::chrono::steady_clock::now();
    if (outcome == OwnerLog::Outcome::kStored) {
      return true;
    }
    if (outcome == OwnerLog::Outcome::kReplaced) {
      end("another worker has it");
      return false;
    }
    std::unique_lock lock(mutex_);
    give_up_where_too_much_waits();
    if (finishing_ && written_ > finish_until_) {
      return false;
    }
    progress_.rest();
    wake_.wait_for(lock, kTryAgain, [&] { return !ended_.empty(); });
    if (!ended_.empty()) {
      return false;
    }
  }
}

void OutStage::pass_on(OutItems::Part&& part) {
  {
    const std::lock_guard lock(mutex_);
    ++counters_.records;
    counters_.items += part.items.size();
    counters_.left_out += part.left_out;
  }
  for (Item& item : part.items) {
    if (auto* const location = std::get_if<Location>(&item)) {
      inner_.location(std::move(*location));
    } else if (auto* const track = std::get_if<TrackEvent>(&item)) {
      inner_.event(std::move(*track));
    } else {
      inner_.event(std::move(std::get<ZoneEvent>(item)));
    }
  }
  inner_.advance(time_of_us(part.output.done_us()));
}

void OutStage::end(const std::string& why) {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    if (ended_.empty()) {
      ended_ = why;
    }
  }
  wake_.notify_all();
}

void OutStage::finish() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = finishing_ = true;
    finish_until_ = std::chrono::steady_clock::now() + kOutFinishTimeout;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::string OutStage::ended() const {
  const std::lock_guard lock(mutex_);
  return ended_;
}

OutStage::Counters OutStage::counters() const {
  const std::lock_guard lock(mutex_);
  Counters counters = counters_;
  counters.waiting = items_.waiting();
  return counters;
}

std::vector<std::string> OutStage::notices() {
  const std::lock_guard lock(mutex_);
  if (counters_.left_out == reported_) {
    return {};
  }
  const std::uint64_t more = counters_.left_out - std::exchange(reported_, counters_.left_out);
  return {
      std::to_string(more) +
      " results were left out: those of one instant are more than the broker takes in a message; "
      "raise its max_payload"};
}

void LaterFrames::tap(const std::string& access_point, std::span<const CsiFrame> frames) {
  const Timestamp from = from_;
  std::vector<CsiFrame> later;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(later), [&](const CsiFrame& frame) {
    return frame.time >= from;
  });
  if (!later.empty()) {
    inner_.tap(access_point, later);
  }
}

}  // namespace rayloc
