#include "daemon/live/live_map/background_text.h"

namespace rayloc {

BackgroundText::~BackgroundText() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  asked_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::string BackgroundText::ask() {
  const std::lock_guard lock(mutex_);
  wanted_ = true;
  if (!thread_.joinable()) {
    thread_ = std::thread([this] { run(); });
  }
  asked_.notify_one();
  return text_;
}

bool BackgroundText::idle() const {
  const std::lock_guard lock(mutex_);
  return !wanted_ && !making_;
}

void BackgroundText::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    asked_.wait(lock, [this] { return wanted_ || ending_; });
    if (ending_) {
      return;
    }
    wanted_ = false;
    making_ = true;
    lock.unlock();
    std::string made = make_();
    lock.lock();
    making_ = false;
    text_ = std::move(made);
  }
}

}  // namespace rayloc
