#include "daemon/cli/arguments/number_list.h"

#include <charconv>
#include <cmath>
#include <string_view>

#include <spdlog/fmt/fmt.h>

namespace rayloc::cli {

Expected<void> parse_number_list(const std::string& option,
                                 const std::string& text,
                                 const std::string& example,
                                 std::span<double> values) {
  const std::string_view all = text;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool last = i + 1 == values.size();
    const std::size_t end = last ? all.size() : all.find(',', begin);
    const std::string_view word =
        end == std::string_view::npos ? "" : all.substr(begin, end - begin);
    const auto [stop, status] = std::from_chars(word.data(), word.data() + word.size(), values[i]);
    if (word.empty() || status != std::errc() || stop != word.data() + word.size() ||
        !std::isfinite(values[i])) {
      return make_error(
          ErrorKind::kUsage,
          fmt::format("{0} {1}: write {2} numbers with commas and without blanks: {0} {3}",
                      option,
                      text,
                      values.size(),
                      example));
    }
    begin = end + 1;
  }
  return {};
}

Expected<Vec3d> parse_point(const std::string& option, const std::string& text) {
  std::array<double, 3> v{};
  RAYLOC_TRY(parse_number_list(option, text, "1.2,-0.4,2.1", v));
  return Vec3d{v[0], v[1], v[2]};
}

}  // namespace rayloc::cli
