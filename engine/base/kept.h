// Lazy, Kept and Tally: values that several threads request and one of them makes. No oneTBB:
// headers may include this file (parallel.h has the loops).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <unordered_map>

namespace rayloc {

// A value that the first caller makes. Threads that ask at the same time may each make one; all use
// the one that is kept. No lock is held meanwhile.
template <typename T>
class Lazy {
 public:
  Lazy() = default;
  ~Lazy() { delete value_.load(std::memory_order_relaxed); }
  Lazy(const Lazy&) = delete;
  Lazy& operator=(const Lazy&) = delete;

  // make(): a std::unique_ptr to the T. REQUIRES: every call makes the same value.
  template <typename Make>
  const T& get(const Make& make) const {
    const T* value = value_.load(std::memory_order_acquire);
    if (value == nullptr) {
      std::unique_ptr<const T> made = make();
      if (value_.compare_exchange_strong(
              value, made.get(), std::memory_order_acq_rel, std::memory_order_acquire)) {
        value = made.release();
      }
    }
    return *value;
  }

  // nullptr before the first request.
  const T* if_made() const { return value_.load(std::memory_order_acquire); }

 private:
  mutable std::atomic<const T*> value_ = nullptr;
};

// Values by number, made on request and kept while there is room; the oldest values are removed
// first. The set of kept values affects only the time of a request.
template <typename T>
class Kept {
 public:
  // most: a count of values.
  explicit Kept(std::size_t most) : most_of_shard_(most / kShards + 1) {}

  // make(): a T. REQUIRES: every call makes the same value.
  template <typename Make>
  std::shared_ptr<const T> get(std::size_t number, const Make& make) const {
    Shard& shard = shards_[number % kShards];
    {
      const std::lock_guard lock(shard.mutex);
      if (const auto found = shard.values.find(number); found != shard.values.end()) {
        return found->second;
      }
    }
    auto made = std::make_shared<const T>(make());
    const std::lock_guard lock(shard.mutex);
    if (shard.values.emplace(number, made).second) {
      shard.order.push_back(number);
      if (shard.order.size() > most_of_shard_) {
        shard.values.erase(shard.order.front());
        shard.order.pop_front();
      }
    }
    return made;
  }

 private:
  static constexpr std::size_t kShards = 16;  // a count, chosen: threads rarely wait for each other
  struct Shard {
    std::mutex mutex;
    std::unordered_map<std::size_t, std::shared_ptr<const T>> values;
    std::deque<std::size_t> order;  // in order of construction
  };
  std::size_t most_of_shard_;
  mutable std::array<Shard, kShards> shards_;
};

// Number of requests of a value; it may decide what is worth keeping, but affects no result.
class Tally {
 public:
  void add() const { count_.fetch_add(1, std::memory_order_relaxed); }
  std::uint32_t count() const { return count_.load(std::memory_order_relaxed); }

 private:
  mutable std::atomic<std::uint32_t> count_ = 0;
};

}  // namespace rayloc
