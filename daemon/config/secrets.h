// The files that hold secrets: the token of HTTP, the key of [privacy], the secret key of [curve],
// the seed of [cluster].
//
// A daemon whose user systemd makes up at each start (DynamicUser=) cannot read what root keeps for
// itself. systemd can, and passes it as a credential (systemd.exec(5), LoadCredential=), which is
// taken where the configuration names no file: http.token, privacy.key, curve.secret,
// cluster.nkey.
#pragma once

#include <filesystem>
#include <string>

#include "daemon/config/config.h"
#include "engine/base/expected.h"

namespace rayloc {

// Names the credentials that systemd passed as the files that the configuration leaves out.
void take_credentials(DaemonConfig& config);

// The first line of the file. kConfiguration where it cannot be read or is too short for a token.
Expected<std::string> read_http_token(const std::filesystem::path& file);

// That each secret which the configuration asks for can be read and is one. kConfiguration: a line
// for each that is not.
Expected<void> check_secrets(const DaemonConfig& config);

}  // namespace rayloc
