// The files that hold secrets: the token of HTTP, the key of [privacy], the secret key of [curve],
// the seed of [cluster].
//
// A daemon whose user systemd creates at each start (DynamicUser=) cannot read files that belong
// to root. systemd can, and passes them as credentials (systemd.exec(5), LoadCredential=), which
// are used if the configuration names no file: http.token, privacy.key, curve.secret,
// cluster.nkey.
#pragma once

#include <filesystem>
#include <string>

#include "daemon/live/config/config.h"
#include "engine/base/expected.h"

namespace rayloc {

// Sets the credentials passed by systemd as the files that the configuration leaves out.
void take_credentials(DaemonConfig& config);

// The first line of the file. kConfiguration if it cannot be read or is too short for a token.
Expected<std::string> read_http_token(const std::filesystem::path& file);

// Checks that each secret required by the configuration is readable and valid. kConfiguration: a
// line for each that is not.
Expected<void> check_secrets(const DaemonConfig& config);

}  // namespace rayloc
