#include "daemon/cli/arguments/gradient_argument.h"

#include <string_view>

namespace rayloc::cli {
namespace {

constexpr std::string_view kLoss = "power:";

}  // namespace

Expected<std::vector<NamedParameter>> parse_gradient(const std::string& text, const Scene& scene) {
  const auto named = [](Error error) {
    error.message = "--gradient: " + error.message;
    return error;
  };
  if (!text.starts_with(kLoss) || text.size() == kLoss.size()) {
    return make_error(ErrorKind::kUsage,
                      "--gradient: '" + text + "'; write power:WHAT, for example power:rx");
  }
  return parse_parameters(text.substr(kLoss.size()), scene).map_error(named);
}

}  // namespace rayloc::cli
