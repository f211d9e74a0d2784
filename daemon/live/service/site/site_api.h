// The responses of HTTP for one site, from its runtime.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/live/service/site/site_set.h"
#include "daemon/messages/last_messages.h"

namespace rayloc {

// Objects of the process that the responses need.
struct SiteApiOptions {
  std::shared_ptr<const LastMessages> last;
  std::uint64_t epoch = 0;               // of the publisher
  std::function<Readiness()> readiness;  // of this site; called on the server's thread
  // Called on the server's thread when the editor has written files; the result is shown to its
  // user. Null: the site cannot be edited.
  std::function<std::string()> on_saved;
  SiteSet::Site before;  // the same site before a reload; null: none
};

// Sets RunningSite::api and channel. REQUIRES: the site has a board, and its runtime is open.
// Handlers hold the objects that they read from, for as long as requests may use them.
void open_site_api(RunningSite& running, SiteApiOptions options);

}  // namespace rayloc
