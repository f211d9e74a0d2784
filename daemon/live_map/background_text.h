// BackgroundText: a text that takes long to make, for a thread that must not wait: made by a thread
// of its own when somebody asks, and given to who asks next.
//
// One is made at a time, however many ask; nobody asks, and there is no thread. Thread safety:
// ask() from any thread.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace rayloc {

class BackgroundText {
 public:
  // `make`: called on the thread, while nobody else calls it. `first`: what there is before.
  BackgroundText(std::function<std::string()> make, std::string first)
      : make_(std::move(make)), text_(std::move(first)) {}
  // Waits for what is being made.
  ~BackgroundText();
  BackgroundText(const BackgroundText&) = delete;
  BackgroundText& operator=(const BackgroundText&) = delete;

  // The last one, at once; the next is made meanwhile.
  std::string ask();
  // Whether nothing is being made, nor asked for: the destructor would not wait.
  bool idle() const;

 private:
  void run();

  const std::function<std::string()> make_;
  mutable std::mutex mutex_;
  std::condition_variable asked_;
  std::string text_;     // guarded by mutex_
  bool wanted_ = false;  // guarded by mutex_
  bool making_ = false;  // guarded by mutex_
  bool ending_ = false;  // guarded by mutex_
  std::thread thread_;   // from the first question on; last: it uses the others
};

}  // namespace rayloc
