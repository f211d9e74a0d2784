// `rayloc wait-ready`: returns when raylocd is ready, for scripts and dependent units.
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "daemon/cli/arguments/http_options.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

constexpr auto kInterval = std::chrono::milliseconds(200);

std::string reasons_of(const nlohmann::json& ready) {
  std::string text;
  for (const nlohmann::json& reason : ready.value("reasons", nlohmann::json::array())) {
    text += (text.empty() ? "" : "; ") + reason.get<std::string>();
  }
  return text;
}

// Returns the reason why it is not ready; empty when it is ready.
Expected<std::string> obstacle(const HttpQuery& query, bool sources) {
  const Expected<JsonResult> ready = get_json(query, "/readyz");
  if (!ready) {
    // No process listens yet: that is the case to wait for.
    return ready.error().kind == ErrorKind::kUsage
               ? Expected<std::string>(tl::make_unexpected(ready.error()))
               : Expected<std::string>(ready.error().message);
  }
  return ready->status == 200 || !sources ? std::string() : reasons_of(ready->json);
}

Expected<void> run_wait_ready(const HttpOptions& options, double timeout, bool sources) {
  const Expected<HttpQuery> query = query_of(options);
  RAYLOC_TRY(query);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout);
  while (true) {
    const Expected<std::string> why = obstacle(*query, sources);
    RAYLOC_TRY(why);
    if (why->empty()) {
      return {};
    }
    if (std::chrono::steady_clock::now() >= deadline) {
      return make_error(ErrorKind::kUnavailable, "not ready: " + *why);
    }
    std::this_thread::sleep_for(kInterval);
  }
}

RunVerb declare_wait_ready(OptionParser& app) {
  const auto options = add_http_options(app);
  const auto timeout = std::make_shared<double>(60.0);
  const auto running = std::make_shared<bool>(false);
  app.add_option("--timeout", *timeout, "Give up with status 69 after so many seconds")
      ->check(not_negative())
      ->capture_default_str();
  app.add_flag("--running",
               *running,
               "Wait only until raylocd runs, also without a frame of its access points");
  return [options, timeout, running] { return run_wait_ready(*options, *timeout, !*running); };
}

}  // namespace

extern const Verb kWaitReady;
const Verb kWaitReady = {
    "wait-ready",
    "Wait until raylocd is ready: runs, can locate, and receives from every access point",
    "rayloc wait-ready --timeout 30 && echo go",
    declare_wait_ready};

}  // namespace rayloc::cli
