#include "daemon/live/cluster/batch_sender.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "daemon/live/cluster/cluster_names.h"

namespace rayloc {
namespace {

constexpr auto kSenderFinishTimeout = std::chrono::seconds(1);
constexpr auto kStreamCheckInterval = std::chrono::seconds(1);  // for a missing stream
constexpr auto kFlush = std::chrono::milliseconds(10);
constexpr std::size_t kMaxPerRound = 64;  // messages, before new batches are checked

}  // namespace

class BatchSender::Tap final : public DatagramTap {
 public:
  Tap(BatchSender& sender, std::size_t access_point)
      : sender_(sender), access_point_(access_point) {}
  void tap(std::span<const Datagram> datagrams) override {
    if (!datagrams.empty()) {
      sender_.take(access_point_, datagrams);
    }
  }
  void advance(Timestamp watermark) override { sender_.advance(access_point_, watermark); }

 private:
  BatchSender& sender_;
  const std::size_t access_point_;
};

BatchSender::BatchSender(std::shared_ptr<Broker> broker, Options options)
    : broker_(std::move(broker)),
      options_(std::move(options)),
      subject_(csi_subject(options_.site, options_.node)),
      fill_subject_(fill_subject(options_.site, options_.node)),
      ring_(options_.epoch, options_.limits),
      fill_(options_.fill) {}

BatchSender::~BatchSender() { finish(); }

DatagramTap& BatchSender::tap(const std::string& access_point) {
  const std::lock_guard lock(mutex_);
  open_.push_back({{access_point, Timestamp::min(), {}}});
  return taps_.emplace_back(*this, open_.size() - 1);
}

Expected<void> BatchSender::start() {
  auto publisher = broker_->acked_publisher(
      [this](std::uint64_t number, const std::string& why) { note_acknowledged(number, why); });
  RAYLOC_TRY(publisher);
  auto fill = broker_->acked_publisher(
      [this](std::uint64_t number, const std::string& why) { note_filled(number, why); });
  RAYLOC_TRY(fill);
  publisher_ = std::move(*publisher);
  fill_publisher_ = std::move(*fill);
  sealed_ = std::chrono::steady_clock::now();
  thread_ = std::thread([this] { run(); });
  return {};
}

void BatchSender::take(std::size_t access_point, std::span<const Datagram> datagrams) {
  const Time now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  Open& open = open_[access_point];
  captured_[open.part.access_point] += datagrams.size();
  // The thread sleeps until the next tick, or until the previous batch was due.
  bool is_due_sooner = open_datagrams_ == 0 && !datagrams.empty();
  for (const Datagram& datagram : datagrams) {
    if (open_datagrams_ > 0 && (open_datagrams_ >= options_.max_datagrams ||
                                open_bytes_ + datagram.payload.size() > options_.max_bytes)) {
      seal(now);
      is_due_sooner = true;
    }
    if (open_datagrams_ == 0) {
      opened_ = now;
    }
    auto& piece = open.part.datagrams;
    piece.entries.push_back({datagram.time, datagram.address, datagram.payload.size()});
    piece.payloads.insert(piece.payloads.end(), datagram.payload.begin(), datagram.payload.end());
    ++open_datagrams_;
    open_bytes_ += datagram.payload.size();
  }
  if (is_due_sooner) {
    awake_ = true;
    wake_.notify_one();
  }
}

void BatchSender::advance(std::size_t access_point, Timestamp watermark) {
  const std::lock_guard lock(mutex_);
  open_[access_point].part.watermark = watermark;
}

// REQUIRES: the mutex is held. Seals the data of every access
// point, and the watermarks of access points without data.
void BatchSender::seal(Time now) {
  Batch batch;
  batch.clock_synchronised = options_.clock_synchronised && options_.clock_synchronised();
  for (Open& open : open_) {
    if (open.part.datagrams.entries.empty() && open.part.watermark == open.last_watermark) {
      continue;
    }
    // Before the first watermark, the time of the first datagram is a valid lower bound.
    const Timestamp watermark = open.part.watermark == Timestamp::min()
                                    ? open.part.datagrams.entries.front().time
                                    : open.part.watermark;
    batch.parts.push_back(
        {open.part.access_point, watermark, std::exchange(open.part.datagrams, {})});
    open.last_watermark = open.part.watermark;
  }
  open_datagrams_ = 0;
  open_bytes_ = 0;
  sealed_ = now;
  ring_.add(std::move(batch), now);
}

void BatchSender::note_acknowledged(std::uint64_t number, const std::string& trouble) {
  {
    const std::lock_guard lock(mutex_);
    trouble_ = trouble.empty() ? "" : subject_ + ": " + trouble;
    if (!trouble.empty()) {  // sent again when not acknowledged for long enough
      ++refused_;
      is_stream_suspect_ = true;
      return;
    }
    ring_.acknowledged(number);
    awake_ = awake_ || ring_.has_next();
    if (!awake_) {
      return;
    }
  }
  wake_.notify_one();  // the window has room again
}

// A refused one is sent again when it has not been acknowledged for long enough.
void BatchSender::note_filled(std::uint64_t number, const std::string& trouble) {
  if (!trouble.empty()) {
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    fill_.acknowledged(number);
    awake_ = true;
  }
  wake_.notify_one();
}

void BatchSender::run() {
  pthread_setname_np(pthread_self(), "batches");  // for top -H
  while (next_round()) {
    see_to_stream();
    send_some();
    send_history();
  }
  flush_all();
  progress_.rest();
}

// Waits for work; returns true if there is another round.
bool BatchSender::next_round() {
  std::unique_lock lock(mutex_);
  progress_.beat();
  wake_.wait_until(lock, due(), [&] { return finishing_ || awake_; });
  awake_ = false;
  const Time now = std::chrono::steady_clock::now();
  if (now >= due()) {
    seal(now);
  }
  ring_.tend(now);
  for (const Batch& batch : ring_.take_left_out()) {
    fill_.add(batch);
  }
  return !finishing_;
}

// REQUIRES: the mutex is held.
BatchSender::Time BatchSender::due() const {
  const Time tick = sealed_ + options_.tick;
  return open_datagrams_ > 0 ? std::min(tick, opened_ + options_.flush) : tick;
}

// A server restart deletes a stream in memory. A node without the right to create it finds it.
void BatchSender::see_to_stream() {
  const Time now = std::chrono::steady_clock::now();
  if (!broker_->connected() || now - checked_ < kStreamCheckInterval) {
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    if (!is_stream_suspect_ && broker_->connections() == connections_) {
      return;
    }
    is_stream_suspect_ = false;
  }
  connections_ = broker_->connections();
  const Expected<void> there = broker_->ensure_stream(options_.stream);
  checked_ = std::chrono::steady_clock::now();  // batches are sent before the next check
  if (!there) {
    const std::lock_guard lock(mutex_);
    trouble_ = there.error().message;
    is_stream_suspect_ = true;
  }
}

void BatchSender::send_some() {
  if (!broker_->connected()) {
    return;
  }
  std::vector<NumberedRing::Ready> ready;
  {
    const std::lock_guard lock(mutex_);
    const Time now = std::chrono::steady_clock::now();
    while (ready.size() < kMaxPerRound) {
      auto one = ring_.next(now);
      if (!one) {
        break;
      }
      ready.push_back(std::move(*one));
    }
    awake_ = awake_ || ready.size() == kMaxPerRound;  // more batches are waiting
  }
  for (const NumberedRing::Ready& one : ready) {
    const auto sent = publisher_->publish(subject_, *one.bytes, id_of(one), one.number);
    if (!sent) {
      const std::lock_guard lock(mutex_);
      trouble_ = sent.error().message;
      ring_.not_sent(one.number);
    }
  }
}

// Sends one batch at a time; live data never wait for it.
void BatchSender::send_history() {
  std::optional<FillQueue::Ready> ready;
  {
    const std::lock_guard lock(mutex_);
    if (broker_->connected() && !ring_.has_next()) {
      ready = fill_.next(std::chrono::steady_clock::now());
    }
  }
  if (ready) {  // on a failure it is sent again
    (void)fill_publisher_->publish(
        fill_subject_,
        *ready->bytes,
        fmt::format("{}-{:x}-{}-f{}", options_.node, options_.epoch, options_.site, ready->number),
        ready->number);
  }
}

// The broker stores each batch once, except those that a reader has requested again.
std::string BatchSender::id_of(const NumberedRing::Ready& batch) const {
  return fmt::format("{}-{:x}-{}-{}{}",
                     options_.node,
                     options_.epoch,
                     options_.site,
                     batch.number,
                     batch.repeat == 0 ? "" : fmt::format("-r{}", batch.repeat));
}

void BatchSender::flush_all() {
  const Time deadline = std::chrono::steady_clock::now() + kSenderFinishTimeout;
  {
    const std::lock_guard lock(mutex_);
    seal(std::chrono::steady_clock::now());
  }
  if (checked_ == Time{}) {  // it ends before its first round
    see_to_stream();
  }
  while (std::chrono::steady_clock::now() < deadline && broker_->connected()) {
    send_some();
    std::unique_lock lock(mutex_);
    if (!ring_.owes()) {
      break;
    }
    wake_.wait_for(lock, kFlush);
  }
}

void BatchSender::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
  publisher_.reset();
  fill_publisher_.reset();
}

void BatchSender::consumed(std::uint64_t epoch, std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  if (epoch == options_.epoch) {
    ring_.consumed(number);
  }
}

void BatchSender::ask(std::uint64_t epoch, std::uint64_t from, std::uint64_t to) {
  {
    const std::lock_guard lock(mutex_);
    if (epoch != options_.epoch) {
      return;
    }
    ring_.ask(from, to);
    awake_ = true;
  }
  wake_.notify_one();
}

BatchSender::Counters BatchSender::counters() const {
  Counters counters;
  counters.connected = broker_->connected();
  const std::lock_guard lock(mutex_);
  counters.ring = ring_.counters();
  counters.captured = captured_;
  counters.filled = fill_.filled();
  counters.to_fill = fill_.waiting();
  counters.refused = refused_;
  for (const Open& open : open_) {  // datagrams that are in no batch yet wait as well
    counters.captured.try_emplace(open.part.access_point, 0);
    counters.ring.waiting[open.part.access_point] += open.part.datagrams.entries.size();
  }
  return counters;
}

std::string BatchSender::trouble() const {
  if (!broker_->connected()) {
    return "no broker answers";
  }
  const std::lock_guard lock(mutex_);
  return trouble_;
}

}  // namespace rayloc
