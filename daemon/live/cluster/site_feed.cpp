#include "daemon/live/cluster/site_feed.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "daemon/live/cluster/batch.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFeedRound{20};     // between checks for missing data
constexpr milliseconds kFull{5};           // between checks for free room
constexpr std::chrono::seconds kAgain{1};  // until an unanswered request or record is repeated
constexpr milliseconds kPlaces{100};       // between places for resuming
constexpr std::size_t kMaxPlaces = 4096;   // some minutes; then every other one is dropped

// Keeps the entries with wanted times; returns the number of removed entries.
template <typename Wanted>
std::size_t keep_only(const Wanted& wanted, DatagramRing::Piece& piece) {
  if (std::all_of(piece.entries.begin(), piece.entries.end(), [&](const auto& entry) {
        return wanted(entry.time);
      })) {
    return 0;
  }
  DatagramRing::Piece kept;
  for (const Datagram& one : piece.datagrams()) {
    if (wanted(one.time)) {
      kept.entries.push_back({one.time, one.address, one.payload.size()});
      kept.payloads.insert(kept.payloads.end(), one.payload.begin(), one.payload.end());
    }
  }
  const std::size_t dropped = piece.entries.size() - kept.entries.size();
  piece = std::move(kept);
  return dropped;
}

}  // namespace

Expected<std::unique_ptr<SiteFeed>> SiteFeed::open(std::shared_ptr<Broker> broker,
                                                   Options options) {
  std::unique_ptr<SiteFeed> feed(new SiteFeed(std::move(broker), std::move(options)));
  StreamReader::Options reading;
  reading.stream = csi_stream(feed->options_.site);
  reading.again = live_subjects(feed->options_.site);
  reading.after = feed->options_.resume.place;
  auto reader = StreamReader::open(feed->broker_, std::move(reading));
  RAYLOC_TRY(reader);
  feed->reader_ = std::move(*reader);
  return feed;
}

SiteFeed::SiteFeed(std::shared_ptr<Broker> broker, Options options)
    : broker_(std::move(broker)),
      options_(std::move(options)),
      waiting_bytes_(std::make_shared<std::atomic<std::size_t>>(0)),
      sequencer_(options_.resume.nodes, false),
      shed_level_(options_.resume.shed_level),
      shed_rule_(options_.shed),
      only_listens_(options_.only_listens || options_.until) {
  checkpoints_.push_back({options_.resume, Timestamp::min()});
  for (const std::string& node : options_.resume.silent) {
    nodes_[node].silent = true;
  }
  lanes_.reserve(options_.access_points.size());
  for (std::size_t i = 0; i < options_.access_points.size(); ++i) {
    lanes_.push_back(std::make_shared<FeedLane>(waiting_bytes_));
  }
}

SiteFeed::~SiteFeed() { finish(); }

std::unique_ptr<DatagramSource> SiteFeed::source(std::size_t access_point) {
  return std::make_unique<FeedSource>(
      lanes_.at(access_point), broker_, "cluster stream " + csi_stream(options_.site));
}

void SiteFeed::start() {
  thread_ = std::thread([this] { run(); });
}

void SiteFeed::finish() {
  ending_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

void SiteFeed::run() {
  pthread_setname_np(pthread_self(), "site feed");  // for top -H
  Time tended{};
  bool is_over = false;
  while (!ending_ && !is_over) {
    progress_.beat();
    make_stream();
    if (const auto message = reader_->next(kFeedRound)) {
      take(*message);
      note_place();
    }
    const Time now = std::chrono::steady_clock::now();
    if (now - tended >= kFeedRound) {
      tended = now;
      tend(now);
    }
    is_over = options_.until && reader_->place().sequence >= *options_.until;
    wait_for_room();
  }
  if (options_.until) {
    for (const auto& lane : lanes_) {
      lane->end(is_over);
    }
  }
  progress_.rest();
}

void SiteFeed::tend(Time now) {
  if (!only_listens_) {
    ask_for_holes(now);
    report_silent_nodes(now);
    report_shedding(now);
  }
  note();
}

// Creates the stream, since a capture node may lack the permission.
void SiteFeed::make_stream() {
  if (!only_listens_ && broker_->connected() && broker_->connections() != connections_ &&
      broker_->ensure_stream(options_.stream)) {
    connections_ = broker_->connections();
  }
}

void SiteFeed::take(const BrokerMessage& message) {
  const std::string node = token_name(last_token(message.subject));
  if (message.subject == owner_subject(options_.site)) {
    take_owner_record(message);
    return;
  }
  auto batch = decode_batch(message.data);
  if (!batch) {
    ++refused_;
    return;
  }
  nodes_[node].last_received = std::chrono::steady_clock::now();
  std::vector<Sequencer::Taken> taken;
  sequencer_.push(node, std::move(*batch), taken);
  for (Sequencer::Taken& one : taken) {
    deliver(std::move(one));
  }
  promise_for_silent_ones();
}

// A silence record is obsolete for a node that has been received since.
void SiteFeed::take_owner_record(const BrokerMessage& message) {
  v1::OwnerRecord record;
  if (!unseal(message.data, record)) {
    ++refused_;
    return;
  }
  if (record.has_shed()) {
    shed_level_ = std::min(record.shed().level(), kMaxShed);
    return;
  }
  const v1::NodeSilent& silent = record.silent();
  const Sequencer::Positions positions = sequencer_.positions();
  const auto found = positions.find(silent.node());
  if (record.has_silent() && found != positions.end() && found->second.epoch == silent.epoch() &&
      found->second.number == silent.number() && !nodes_[silent.node()].silent) {
    nodes_[silent.node()].silent = true;
    ++silences_;
    promise_for_silent_ones();
  }
}

void SiteFeed::deliver(Sequencer::Taken taken) {
  nodes_[taken.node].silent = false;
  for (BatchPart& part : taken.batch.parts) {
    const auto found =
        std::find(options_.access_points.begin(), options_.access_points.end(), part.access_point);
    if (found == options_.access_points.end()) {
      unknown_ += part.datagrams.entries.size();
      continue;
    }
    FeedLane& lane = *lanes_[static_cast<std::size_t>(found - options_.access_points.begin())];
    lane.node = taken.node;
    for (const auto& entry : part.datagrams.entries) {
      newest_ = std::max(newest_, entry.time);
    }
    lane.count_rejected(
        "late_node",
        keep_only([&](Timestamp time) { return time >= lane.watermark; }, part.datagrams));
    const std::size_t shed =
        keep_only([&](Timestamp time) { return is_used(time, shed_level_); }, part.datagrams);
    lane.count_rejected("shed", shed);
    shed_ += shed;
    lane.watermark = std::max(lane.watermark, part.watermark);
    lane.put(std::move(part.datagrams), lane.watermark);
  }
}

bool SiteFeed::is_waited_for(const FeedLane& lane) const {
  const auto node = nodes_.find(lane.node);
  return !lane.node.empty() && (node == nodes_.end() || !node->second.silent);
}

// Least watermark of the lanes that are waited for; nothing where there is none.
std::optional<Timestamp> SiteFeed::promised() const {
  std::optional<Timestamp> safe;
  for (const auto& lane : lanes_) {
    if (is_waited_for(*lane)) {
      safe = std::min(safe.value_or(Timestamp::max()), lane->watermark);
    }
  }
  return safe;
}

void SiteFeed::promise_for_silent_ones() {
  const std::optional<Timestamp> safe = promised();
  for (const auto& lane : lanes_) {
    if (safe && !is_waited_for(*lane) && lane->watermark < *safe) {
      lane->watermark = *safe;
      lane->put({}, *safe);
    }
  }
}

void SiteFeed::ask_for_holes(Time now) {
  std::map<Sequencer::Hole, Time> holes;
  for (const Sequencer::Hole& hole : sequencer_.holes()) {
    const auto known = holes_.find(hole);
    Time due = known == holes_.end() ? now + options_.ask_after : known->second;
    if (now >= due) {
      v1::ResendRequest request;
      request.set_site(options_.site);
      request.set_epoch(hole.epoch);
      request.set_from_number(hole.from);
      request.set_to_number(hole.to);
      (void)broker_->publish(resend_subject(hole.node), seal(request));  // repeated if unsuccessful
      due = now + kAgain;
    }
    holes.emplace(hole, due);
  }
  holes_ = std::move(holes);
}

void SiteFeed::report_silent_nodes(Time now) {
  const bool any_node = std::any_of(nodes_.begin(), nodes_.end(), [&](const auto& node) {
    return now - node.second.last_received < options_.silent_after / 2;
  });
  for (auto& [name, node] : nodes_) {
    if (!any_node || node.silent || now - node.last_received < options_.silent_after ||
        now - node.reported < kAgain) {
      continue;
    }
    node.reported = now;
    const Sequencer::Positions positions = sequencer_.positions();
    const auto at = positions.find(name);
    if (at == positions.end()) {
      continue;
    }
    v1::OwnerRecord record;
    record.mutable_silent()->set_node(name);
    record.mutable_silent()->set_epoch(at->second.epoch);
    record.mutable_silent()->set_number(at->second.number);
    (void)broker_->publish(owner_subject(options_.site), seal(record));
  }
}

// The level is applied when the record is read from the stream. The promised watermark bounds
// what could be explained by now: a node with a wrong clock delays others, and that is no load.
void SiteFeed::report_shedding(Time now) {
  const auto level =
      shed_rule_.next_level(promised().value_or(Timestamp::min()), done_, shed_level_, now);
  if (!level) {
    return;
  }
  v1::OwnerRecord record;
  record.mutable_shed()->set_level(*level);
  (void)broker_->publish(owner_subject(options_.site), seal(record));  // repeated if unsuccessful
}

// While one source has no data, the others may be waiting for it.
void SiteFeed::wait_for_room() {
  progress_.rest();
  while (
      !ending_ && *waiting_bytes_ > options_.max_waiting_bytes &&
      std::none_of(lanes_.begin(), lanes_.end(), [](const auto& lane) { return lane->empty(); })) {
    std::this_thread::sleep_for(kFull);
  }
}

// A held batch was read and not taken: a reader that resumed after it would miss it.
void SiteFeed::note_place() {
  if (sequencer_.has_holes()) {
    return;
  }
  const std::lock_guard lock(mutex_);
  const Timestamp last = checkpoints_.back().newest;
  if (newest_ > last && newest_ < last + kPlaces) {
    return;
  }
  SiteResume here{reader_->place(), sequencer_.positions(), {}, shed_level_};
  for (const auto& [name, node] : nodes_) {
    if (node.silent) {
      here.silent.insert(name);
    }
  }
  if (newest_ == last) {  // no new data: the later place replaces it
    checkpoints_.back().resume = std::move(here);
    return;
  }
  checkpoints_.push_back({std::move(here), newest_});
  if (checkpoints_.size() > kMaxPlaces) {
    std::size_t i = 0;
    std::erase_if(checkpoints_, [&](const Checkpoint&) { return i++ % 2 == 1; });
  }
}

SiteResume SiteFeed::resume_for(Timestamp time) {
  const std::lock_guard lock(mutex_);
  while (checkpoints_.size() > 1 && checkpoints_[1].newest < time) {
    checkpoints_.pop_front();
  }
  return checkpoints_.front().resume;
}

void SiteFeed::note() {
  Counters counters;
  counters.stream = reader_->counters();
  counters.batches = sequencer_.counters();
  counters.refused = refused_;
  counters.unknown = unknown_;
  counters.silences = silences_;
  counters.shed = shed_;
  counters.shed_level = shed_level_;
  const std::lock_guard lock(mutex_);
  counters_ = std::move(counters);
}

SiteFeed::Counters SiteFeed::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
