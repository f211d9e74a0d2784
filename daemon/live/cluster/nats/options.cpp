#include "daemon/live/cluster/nats/options.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace rayloc::nats {

Error error_of(const std::string& what, natsStatus status) {
  const char* const details = nats_GetLastError(nullptr);
  std::string message = what + ": " + natsStatus_GetText(status);
  if (details != nullptr && *details != '\0') {
    message += std::string(" (") + details + ")";
  }
  return {ErrorKind::kUnavailable, std::move(message)};
}

Expected<void> secure(natsOptions* made, const BrokerOptions& options, const std::string& nkey) {
  natsStatus status = NATS_OK;
  const auto also = [&status](auto set, auto... arguments) {
    status = status == NATS_OK ? set(arguments...) : status;
  };
  const bool is_encrypted =
      !options.ca_file.empty() || !options.certificate_file.empty() ||
      std::any_of(options.servers.begin(), options.servers.end(), [](const std::string& server) {
        return server.rfind("tls://", 0) == 0;
      });
  if (is_encrypted) {
    also(natsOptions_SetSecure, made, true);
  }
  if (!options.ca_file.empty()) {
    also(natsOptions_LoadCATrustedCertificates, made, options.ca_file.c_str());
  }
  if (!options.certificate_file.empty()) {
    also(natsOptions_LoadCertificatesChain,
         made,
         options.certificate_file.c_str(),
         options.key_file.c_str());
  }
  if (!nkey.empty()) {
    also(natsOptions_SetNKeyFromSeed, made, nkey.c_str(), options.nkey_seed_file.c_str());
  }
  if (status != NATS_OK) {
    Error error = error_of("[cluster] tls_ca, tls_cert, tls_key or nkey_seed_file", status);
    error.kind = ErrorKind::kConfiguration;
    return tl::make_unexpected(std::move(error));
  }
  return {};
}

std::string data_of(natsMsg* message) {
  return {natsMsg_GetData(message), static_cast<std::size_t>(natsMsg_GetDataLength(message))};
}

std::string trouble_in(natsMsg* acknowledgement) {
  if (natsMsg_IsNoResponders(acknowledgement)) {
    return "no stream takes it";
  }
  const std::string data = data_of(acknowledgement);
  if (data.find("\"error\"") == std::string::npos) {
    return data.empty() ? "an empty answer" : "";
  }
  const auto json = nlohmann::json::parse(data, nullptr, false);
  const auto error = json.is_object() ? json.find("error") : json.end();
  return error != json.end() && error->is_object()
             ? error->value("description", std::string("an error"))
             : data;
}

}  // namespace rayloc::nats
