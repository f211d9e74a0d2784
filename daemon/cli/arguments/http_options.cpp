#include "daemon/cli/arguments/http_options.h"

#include <fstream>

namespace rayloc::cli {

std::shared_ptr<HttpOptions> add_http_options(OptionParser& app, const std::string& address) {
  auto options = std::make_shared<HttpOptions>(HttpOptions{address, {}});
  app.add_option("--http", options->address, "HOST:PORT of raylocd's [http] listen")
      ->capture_default_str();
  app.add_option(
      "--token-file", options->token_file, "File with the token, where raylocd asks for one");
  return options;
}

Expected<HttpQuery> query_of(const HttpOptions& options) {
  HttpQuery query{options.address, {}};
  if (!options.token_file.empty()) {
    std::ifstream in(options.token_file);
    if (!std::getline(in, query.token) || query.token.empty()) {
      return make_error(ErrorKind::kUsage, options.token_file + ": no token can be read");
    }
  }
  return query;
}

Expected<JsonResult> get_json(const HttpQuery& query, const std::string& path) {
  const Expected<HttpResult> result = http_get(query, path);
  RAYLOC_TRY(result);
  nlohmann::json json = nlohmann::json::parse(result->body, nullptr, false);
  if (json.is_discarded() || (result->status != 200 && result->status != 503)) {
    return make_error(ErrorKind::kUnavailable,
                      "http://" + query.address + path + " answers with status " +
                          std::to_string(result->status) + "; is it a raylocd?");
  }
  return JsonResult{result->status, std::move(json)};
}

}  // namespace rayloc::cli
