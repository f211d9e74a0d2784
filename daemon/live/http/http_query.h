// One request to a raylocd, for the verbs of `rayloc` that query its state.
#pragma once

#include <string>

#include "engine/base/expected.h"

namespace rayloc {

struct HttpQuery {
  std::string address = "127.0.0.1:8480";  // HOST:PORT
  std::string token = {};                  // empty: none
};

struct HttpResult {
  int status = 0;
  std::string body;
};

// Both wait for some seconds at most. kUsage for an invalid address, kUnavailable if there is no
// answer.
Expected<HttpResult> http_get(const HttpQuery& query, const std::string& path);
// Sends no body.
Expected<HttpResult> http_post(const HttpQuery& query, const std::string& path);

}  // namespace rayloc
