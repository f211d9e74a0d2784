#include "engine/base/check.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "engine/base/check_handler.h"

namespace rayloc {
namespace {

CheckHandler& the_handler() {
  static CheckHandler handler = nullptr;
  return handler;
}

}  // namespace

void set_check_handler(CheckHandler handler) { the_handler() = handler; }

void check_failed(const char* condition, const char* file, int line) {
  const std::string message =
      std::string(file) + ":" + std::to_string(line) + ": check failed: " + condition;
  if (const CheckHandler handler = the_handler()) {
    handler(message);
  }
  std::fprintf(stderr, "%s\n", message.c_str());
  std::abort();
}

}  // namespace rayloc
