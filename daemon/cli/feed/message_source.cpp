#include "daemon/cli/feed/message_source.h"

#include <memory>
#include <utility>

#include "daemon/live/publish/late_subscriber.h"
#include "daemon/live/publish/socket/curve_keys.h"

namespace rayloc::cli {
namespace {

constexpr int kHighWaterMark = 100'000;

template <typename Source>
Receive receive_from(Source source) {
  const auto shared = std::make_shared<Source>(std::move(source));
  return [shared](std::chrono::milliseconds timeout) { return shared->receive(timeout); };
}

Expected<std::optional<CurveClientKeys>> read_keys(const MessageSource& source) {
  if (source.server_key.empty()) {
    return std::nullopt;
  }
  Expected<std::string> server = read_curve_public(source.server_key);
  RAYLOC_TRY(server);
  Expected<CurveKeyPair> own = read_curve_secret(source.key);
  RAYLOC_TRY(own);
  return CurveClientKeys{std::move(*server), std::move(*own)};
}

}  // namespace

void add_source_options(OptionParser& app, MessageSource& source) {
  app.add_option("--endpoint", source.endpoint, "Where raylocd publishes")->capture_default_str();
  app.add_option("--snapshot",
                 source.snapshot,
                 "Begin with the last message of each topic, asked for at this endpoint");
  ParserOption* const server_key =
      app.add_option("--server-key",
                     source.server_key,
                     "File with the public key of a raylocd that publishes with CURVE");
  ParserOption* const key =
      app.add_option("--key", source.key, "File with our own secret key, by `rayloc keygen`");
  server_key->needs(key);
  key->needs(server_key);
}

Expected<Receive> connect(const MessageSource& source, const std::vector<std::string>& topics) {
  const Expected<std::optional<CurveClientKeys>> curve = read_keys(source);
  RAYLOC_TRY(curve);
  if (!source.snapshot.empty()) {
    auto late =
        LateSubscriber::join(source.endpoint, source.snapshot, topics, source.patience, *curve);
    return late ? Expected<Receive>(receive_from(std::move(*late)))
                : tl::make_unexpected(late.error());
  }
  auto subscriber = Subscriber::connect(source.endpoint, topics, kHighWaterMark, *curve);
  return subscriber ? Expected<Receive>(receive_from(std::move(*subscriber)))
                    : tl::make_unexpected(subscriber.error());
}

}  // namespace rayloc::cli
