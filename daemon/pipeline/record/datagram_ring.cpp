#include "daemon/pipeline/record/datagram_ring.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace rayloc {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{64} << 10U;
// A piece is removed as a whole: with few datagrams it must not become too old either.
constexpr Duration kPieceLength = std::chrono::milliseconds(500);

}  // namespace

std::vector<Datagram> DatagramRing::Piece::datagrams() const {
  std::vector<Datagram> all;
  all.reserve(entries.size());
  std::span<const std::byte> left = payloads;
  for (const Entry& entry : entries) {
    all.push_back({entry.time, entry.address, left.first(entry.size)});
    left = left.subspan(entry.size);
  }
  return all;
}

void DatagramRing::tap(std::span<const Datagram> datagrams) {
  const std::lock_guard lock(mutex_);
  for (const Datagram& datagram : datagrams) {
    if (!open_.entries.empty() &&
        (open_.bytes() + datagram.payload.size() > std::min(kPieceBytes, max_bytes_ / 2) ||
         datagram.time - open_.entries.front().time > kPieceLength)) {
      seal();
    }
    open_.entries.push_back({datagram.time, datagram.address, datagram.payload.size()});
    open_.payloads.insert(open_.payloads.end(), datagram.payload.begin(), datagram.payload.end());
  }
  if (!datagrams.empty()) {
    forget(datagrams.back().time);
  }
}

void DatagramRing::moved() {
  const std::lock_guard lock(mutex_);
  pieces_.clear();
  open_ = {};
  bytes_ = 0;
}

// REQUIRES: the mutex is held.
void DatagramRing::seal() {
  // Unused capacity of its vectors is not counted, and may be as large again.
  open_.entries.shrink_to_fit();
  open_.payloads.shrink_to_fit();
  bytes_ += open_.bytes();
  pieces_.push_back(std::make_shared<const Piece>(std::exchange(open_, {})));
}

// REQUIRES: the mutex is held.
void DatagramRing::forget(Timestamp now) {
  while (!pieces_.empty() && (bytes_ + open_.bytes() > max_bytes_ ||
                              now - pieces_.front()->entries.back().time > length_)) {
    bytes_ -= pieces_.front()->bytes();
    pieces_.pop_front();
  }
}

std::vector<std::shared_ptr<const DatagramRing::Piece>> DatagramRing::contents() {
  const std::lock_guard lock(mutex_);
  if (!open_.entries.empty()) {
    seal();
  }
  return {pieces_.begin(), pieces_.end()};
}

}  // namespace rayloc
