// BackgroundText: a text that takes long to compute, for a thread that must not wait: computed by
// its own thread on a request, and returned to the next request.
//
// One text is computed at a time, for any number of requests; without requests there is no thread.
// Thread safety: ask() from any thread.
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
  // `make`: called on the thread, never concurrently. `first`: the text before the first result.
  BackgroundText(std::function<std::string()> make, std::string first)
      : make_(std::move(make)), text_(std::move(first)) {}
  // Waits for the computation in progress.
  ~BackgroundText();
  BackgroundText(const BackgroundText&) = delete;
  BackgroundText& operator=(const BackgroundText&) = delete;

  // Returns the last text at once; the next one is computed meanwhile.
  std::string ask();
  // True if no text is being computed or requested: the destructor would not wait.
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
  std::thread thread_;   // started by the first request; last: it uses the others
};

}  // namespace rayloc
