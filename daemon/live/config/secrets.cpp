#include "daemon/live/config/secrets.h"

#include <unistd.h>

#include <cstdlib>

#include "daemon/base/secret_file.h"
#include "daemon/live/publish/socket/curve_keys.h"
#include "daemon/messages/target_names.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

void take_credential(const char* name, fs::path& file) {
  const char* const credentials = std::getenv("CREDENTIALS_DIRECTORY");
  if (credentials == nullptr || !file.empty()) {
    return;
  }
  // If the file exists and cannot be read, its reader reports the error.
  if (const fs::path passed = fs::path(credentials) / name; access(passed.c_str(), F_OK) == 0) {
    file = passed;
  }
}

template <typename Secret>
void note(const Expected<Secret>& secret, std::string& errors) {
  if (!secret) {
    errors += (errors.empty() ? "" : "\n") + secret.error().message;
  }
}

}  // namespace

void take_credentials(DaemonConfig& config) {
  take_credential("http.token", config.http.token_file);
  take_credential("privacy.key", config.privacy.key_file);
  take_credential("curve.secret", config.curve.secret_file);
  take_credential("cluster.nkey", config.cluster.nkey_seed_file);
}

Expected<std::string> read_http_token(const fs::path& file) {
  constexpr std::size_t kShortest = 16;
  Expected<std::string> token = read_secret(
      file, {"token", "systemd passes a file of root to the daemon (drop-in http-token.conf)"});
  if (token && token->size() < kShortest) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() +
                          ": no token: its first line must have 16 characters or more; write one "
                          "with: (umask 077; openssl rand -hex 32 >" +
                          file.string() + ")");
  }
  return token;
}

Expected<void> check_secrets(const DaemonConfig& config) {
  std::string errors;
  if (config.http.enabled && !config.http.token_file.empty()) {
    note(read_http_token(config.http.token_file), errors);
  }
  if (config.privacy.target_id == TargetId::kHmac && !config.privacy.key_file.empty()) {
    note(TargetNames::read_key(config.privacy.key_file), errors);
  }
  if (config.curve.enabled && !config.curve.secret_file.empty()) {
    note(read_curve_secret(config.curve.secret_file), errors);
  }
  return errors.empty() ? Expected<void>() : make_error(ErrorKind::kConfiguration, errors);
}

}  // namespace rayloc
