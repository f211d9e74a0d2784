#include "daemon/live/cluster/stream_reader.h"

#include <algorithm>
#include <iterator>
#include <thread>
#include <utility>

namespace rayloc {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kReaderCheckInterval{500};  // for a missing stream
constexpr milliseconds kPause{20};                 // while the broker is away or does not answer
// For a message that is reported missing although later ones exist.
constexpr std::chrono::seconds kGonePatience{2};
// An isolated leader considers itself the leader for ten seconds (NATS), and lacks messages
// stored since. For so long, a stream end before the last message read is not accepted.
constexpr std::chrono::seconds kStaleLeader{15};

}  // namespace

Expected<std::unique_ptr<StreamReader>> StreamReader::open(std::shared_ptr<Broker> broker,
                                                           Options options) {
  std::unique_ptr<StreamReader> reader(new StreamReader(std::move(broker), std::move(options)));
  auto subscription = reader->broker_->subscribe(
      reader->options_.again,
      [self = reader.get()](BrokerMessage&& message) { self->take(std::move(message)); });
  RAYLOC_TRY(subscription);
  reader->subscription_ = std::move(*subscription);
  return reader;
}

StreamReader::StreamReader(std::shared_ptr<Broker> broker, Options options)
    : broker_(std::move(broker)), options_(std::move(options)), place_(options_.after) {}

void StreamReader::take(BrokerMessage&& message) {
  if (message.sequence == 0) {
    return;  // not from the stream
  }
  {
    const std::lock_guard lock(mutex_);
    // A stream republishes each once and in order; otherwise it is another stream of that name.
    is_suspect_ = is_suspect_ || message.sequence <= last_sequence_;
    last_sequence_ = message.sequence;
    if (waiting_bytes_ + message.data.size() > options_.max_waiting_bytes) {
      return;
    }
    waiting_bytes_ += message.data.size();
    waiting_.push_back(std::move(message));
  }
  wake_.notify_one();
}

std::optional<BrokerMessage> StreamReader::next(milliseconds timeout) {
  const Time deadline = std::chrono::steady_clock::now() + timeout;
  do {
    if (!broker_->connected() || !check_stream()) {
      std::this_thread::sleep_for(std::min(timeout, kPause));
      continue;
    }
    if (auto message = requested_one()) {
      return accept(std::move(*message), true);
    }
    std::uint64_t hole = 0;
    if (auto message = waiting_one(std::min(deadline, received_ + options_.quiet), hole)) {
      return accept(std::move(*message), false);
    }
    if (hole > 0 || std::chrono::steady_clock::now() >= received_ + options_.quiet) {
      if (auto message = ask_for_next(hole)) {
        return accept(std::move(*message), true);
      }
    }
  } while (std::chrono::steady_clock::now() < deadline);
  return std::nullopt;
}

// Once per connection: the stream may be another one by then. False: its state is unavailable.
bool StreamReader::check_stream() {
  const std::uint64_t connections = broker_->connections();
  {
    const std::lock_guard lock(mutex_);
    if (connections == connections_ && !is_suspect_) {
      return true;
    }
  }
  const Time now = std::chrono::steady_clock::now();
  if (connections_ == 0 && now - checked_ < kReaderCheckInterval) {
    return false;
  }
  checked_ = now;
  const Expected<StreamState> state = broker_->stream_state(options_.stream);
  const std::lock_guard lock(mutex_);
  connections_ = state ? connections : 0;
  trouble_ = state ? "" : state.error().message;
  if (!state) {
    return false;
  }
  if (seems_shorter(*state, now)) {
    connections_ = 0;
    return false;
  }
  is_suspect_ = false;
  received_ = {};  // messages missed while disconnected are requested at once
  const bool any = place_.created == Timestamp{};
  if ((!any && place_.created != state->created) || place_.sequence > state->last) {
    ++counters_.streams;
    place_.sequence = 0;
    requested_.clear();
    waiting_.clear();
    waiting_bytes_ = 0;
  }
  place_.created = state->created;
  if (place_.sequence + 1 < state->first) {
    counters_.lost += place_.sequence > 0 ? state->first - 1 - place_.sequence : 0;
    place_.sequence = state->first - 1;
  }
  return true;
}

// REQUIRES: the mutex is held. True: the same stream, but cut short, perhaps by a stale leader.
bool StreamReader::seems_shorter(const StreamState& state, Time now) {
  if (is_suspect_ || place_.created != state.created || place_.sequence <= state.last) {
    shorter_.reset();
    return false;
  }
  shorter_ = shorter_.value_or(now);
  return now - *shorter_ < kStaleLeader;
}

// Returns the next message, if it is there. Those behind one that was removed are requested again:
// a replica that lacks it may lack others.
std::optional<BrokerMessage> StreamReader::requested_one() {
  if (requested_.empty()) {
    return std::nullopt;
  }
  if (requested_.front().sequence != place_.sequence + 1) {
    requested_.clear();
    return std::nullopt;
  }
  BrokerMessage message = std::move(requested_.front());
  requested_.pop_front();
  return message;
}

// Returns the next message, if it arrives before `until`. `hole`: so many are missing before a
// later one that is there.
std::optional<BrokerMessage> StreamReader::waiting_one(Time until, std::uint64_t& hole) {
  std::unique_lock lock(mutex_);
  for (;;) {
    while (!waiting_.empty() && waiting_.front().sequence <= place_.sequence) {
      waiting_bytes_ -= waiting_.front().data.size();
      waiting_.pop_front();
    }
    if (!waiting_.empty()) {
      break;
    }
    if (wake_.wait_until(lock, until) == std::cv_status::timeout && waiting_.empty()) {
      return std::nullopt;
    }
  }
  if (waiting_.front().sequence > place_.sequence + 1) {
    hole = waiting_.front().sequence - place_.sequence - 1;
    return std::nullopt;
  }
  BrokerMessage message = std::move(waiting_.front());
  waiting_bytes_ -= message.data.size();
  waiting_.pop_front();
  return message;
}

// `hole`: size of the hole; 0: any number of messages may follow.
std::optional<BrokerMessage> StreamReader::ask_for_next(std::uint64_t hole) {
  MessageRange range{place_.sequence + 1, options_.max_requested, options_.max_requested_bytes};
  if (hole > 0) {
    range.messages = static_cast<std::size_t>(std::min<std::uint64_t>(hole, range.messages));
  }
  auto messages = broker_->get_several(options_.stream, range);
  if (!messages) {
    std::this_thread::sleep_for(kPause);
    return std::nullopt;
  }
  requested_.assign(std::make_move_iterator(messages->begin()),
                    std::make_move_iterator(messages->end()));
  if (auto message = requested_one()) {
    return message;
  }
  received_ = std::chrono::steady_clock::now();
  if (hole > 0) {
    return ask_the_leader();
  }
  missing_.reset();
  return std::nullopt;
}

// Retention has removed it, or the queried replica does not have it yet. One
// unanswered request per call is enough: the thread that ends the reader waits for it.
std::optional<BrokerMessage> StreamReader::ask_the_leader() {
  auto message = broker_->get_of_leader(options_.stream, place_.sequence + 1);
  if (!message) {
    std::this_thread::sleep_for(kPause);
    return std::nullopt;
  }
  if (*message) {
    return std::move(*message);
  }
  const Expected<StreamState> state = broker_->stream_state(options_.stream);
  const Time now = std::chrono::steady_clock::now();
  if (!state) {
    return std::nullopt;
  }
  std::uint64_t gone_to = std::max<std::uint64_t>(state->first, 1) - 1;
  if (gone_to <= place_.sequence) {
    missing_ = missing_.value_or(now);
    if (state->last <= place_.sequence || now - *missing_ < kGonePatience) {
      std::this_thread::sleep_for(kPause);
      return std::nullopt;
    }
    gone_to = place_.sequence + 1;  // later ones have been waited for as well
  } else {
    missing_.reset();
  }
  const std::lock_guard lock(mutex_);
  counters_.lost += gone_to - place_.sequence;
  place_.sequence = gone_to;
  return std::nullopt;
}

BrokerMessage StreamReader::accept(BrokerMessage&& message, bool asked_for) {
  place_.sequence = message.sequence;
  missing_.reset();
  // After a requested message, more may have been republished before we subscribed.
  received_ = asked_for ? Time{} : std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  ++counters_.read;
  counters_.asked_for += asked_for ? 1U : 0U;
  return std::move(message);
}

StreamReader::Counters StreamReader::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

std::string StreamReader::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

}  // namespace rayloc
