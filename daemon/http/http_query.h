// One request to a raylocd, for the verbs of `rayloc` that ask how it is.
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

// Both wait for some seconds at most. kUsage for an address that is none, kUnavailable when nobody
// answers.
Expected<HttpResult> http_get(const HttpQuery& query, const std::string& path);
// Without a body.
Expected<HttpResult> http_post(const HttpQuery& query, const std::string& path);

}  // namespace rayloc
