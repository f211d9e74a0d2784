// Options of the verbs that query a running raylocd over HTTP.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "daemon/cli/command/option_parser.h"
#include "daemon/live/http/http_query.h"

namespace rayloc::cli {

struct HttpOptions {
  std::string address;
  std::string token_file;
};

// Adds --http and --token-file. `address` is the default address.
std::shared_ptr<HttpOptions> add_http_options(OptionParser& app,
                                              const std::string& address = "127.0.0.1:8480");

// kUsage if the token file cannot be read.
Expected<HttpQuery> query_of(const HttpOptions& options);

struct JsonResult {
  int status = 0;
  nlohmann::json json;
};
// kUnavailable if no server answers, or a server other than raylocd.
Expected<JsonResult> get_json(const HttpQuery& query, const std::string& path);

}  // namespace rayloc::cli
