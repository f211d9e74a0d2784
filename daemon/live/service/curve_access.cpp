#include "daemon/live/service/curve_access.h"

#include <utility>

namespace rayloc {

Expected<std::shared_ptr<ConnectionGuard>> open_curve_access(const CurveConfig& config,
                                                             std::shared_ptr<LimitedLog> log,
                                                             std::function<void()> on_round) {
  ConnectionGuard::Options options;
  options.on_round = std::move(on_round);
  if (!config.enabled) {
    return std::make_shared<ConnectionGuard>(std::move(options));
  }
  if (config.secret_file.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      "[curve] is enabled, but there is no secret key: set secret_file, or let "
                      "systemd pass the credential curve.secret (drop-in curve.conf)");
  }
  Expected<CurveKeyPair> keys = read_curve_secret(config.secret_file);
  RAYLOC_TRY(keys);
  log_event({LogLevel::kInfo,
             "publishing encrypted (CURVE); subscribers need our public key",
             {{"public_key", keys->public_key}, {"clients", std::to_string(config.allow.size())}}});
  options.secret_key = std::move(keys->secret_key);
  options.allow = config.allow;
  options.on_denied = [log = std::move(log)](const std::string& key, const std::string& address) {
    log->add("denied",
             {LogLevel::kWarning,
              "turned away a client whose key is not in [curve] allow",
              {{"client_key", key}, {"address", address}}});
  };
  return std::make_shared<ConnectionGuard>(std::move(options));
}

}  // namespace rayloc
