// `rayloc snapshot`: makes a running raylocd write the data received in the last half a minute.
#include <memory>

#include <fmt/format.h>

#include "daemon/cli/arguments/http_options.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

Expected<void> run_snapshot(const HttpOptions& options) {
  const Expected<HttpQuery> query = query_of(options);
  RAYLOC_TRY(query);
  const Expected<HttpResult> result = http_post(*query, "/api/v1/record/snapshot");
  RAYLOC_TRY(result);
  const nlohmann::json json = nlohmann::json::parse(result->body, nullptr, false);
  if (json.is_object() && json.contains("files")) {
    for (const nlohmann::json& file : json.at("files")) {
      fmt::print("{}\n", file.get<std::string>());
    }
    return {};
  }
  const std::string why = json.is_object() ? json.value("error", "") : "";
  return make_error(ErrorKind::kUnavailable,
                    why.empty() ? "http://" + options.address + " answers with status " +
                                      std::to_string(result->status) + "; is it a raylocd?"
                                : why);
}

RunVerb declare_snapshot(OptionParser& app) {
  const auto options = add_http_options(app);
  app.footer(app.get_footer() + R"(

Prints the recordings, one per access point, that raylocd begins to write: the
datagrams of the last [record] ring_s. The signal SIGUSR1 makes raylocd do the same.)");
  return [options] { return run_snapshot(*options); };
}

}  // namespace

extern const Verb kSnapshot;
const Verb kSnapshot = {
    "snapshot",
    "Write what raylocd received lately to recordings, for looking into a trouble",
    "rayloc snapshot --http 127.0.0.1:8480",
    declare_snapshot};

}  // namespace rayloc::cli
