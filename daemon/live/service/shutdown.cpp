#include "daemon/live/service/shutdown.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace rayloc {

Shutdown::~Shutdown() {
  for (Step& step : late_) {
    step.thread.detach();
  }
}

void Shutdown::begin(const std::string& name, std::function<void()> step) {
  std::packaged_task<void()> task(std::move(step));
  std::future<void> done = task.get_future();
  late_.push_back({name, std::move(done), std::thread(std::move(task))});
}

bool Shutdown::run(const std::string& name, Time deadline, std::function<void()> step) {
  begin(name, std::move(step));
  return wait_for(name, std::max(deadline, std::chrono::steady_clock::now() + kMinTime));
}

bool Shutdown::wait_for(const std::string& name, Time deadline) {
  const auto step =
      std::find_if(late_.begin(), late_.end(), [&](const Step& one) { return one.name == name; });
  if (step == late_.end()) {
    return true;
  }
  if (step->done.wait_until(deadline) == std::future_status::timeout) {
    return false;
  }
  step->thread.join();
  std::future<void> done = std::move(step->done);
  late_.erase(step);
  done.get();  // rethrows its exception
  return true;
}

bool Shutdown::all_returned() {
  for (const std::string& name : hung()) {
    try {
      (void)wait_for(name, std::chrono::steady_clock::now());
    } catch (const std::exception& error) {
      failures_.push_back({name, error.what()});
    }
  }
  return late_.empty();
}

std::vector<std::string> Shutdown::hung() const {
  std::vector<std::string> names;
  names.reserve(late_.size());
  for (const Step& step : late_) {
    names.push_back(step.name);
  }
  return names;
}

}  // namespace rayloc
