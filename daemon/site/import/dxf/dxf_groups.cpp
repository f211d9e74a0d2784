#include "daemon/site/import/dxf/dxf_groups.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/utf8_text.h"

namespace rayloc {
namespace {

constexpr double kMaxInteger = 65536.0;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view kEscape = "\\U+";  // before the four digits of a character

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos
             ? ""
             : text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

}  // namespace

DxfGroups::DxfGroups(const std::filesystem::path& file) : file_(file.string()), in_(file) {
  next();
}

void DxfGroups::next() {
  std::string code;
  std::string value;
  now_ = {-1, "", line_ + 1};
  if (!std::getline(in_, code)) {
    ended_ = true;
    return;
  }
  ++line_;
  if (line_ == 1 && code.starts_with(kByteOrderMark)) {
    code.erase(0, kByteOrderMark.size());
  }
  const std::string digits = trimmed(code);
  const auto [end, failed] =
      std::from_chars(digits.data(), digits.data() + digits.size(), now_.code);
  if (failed != std::errc() || end != digits.data() + digits.size()) {
    fail(fmt::format("'{}' is no group code of a DXF", digits.substr(0, 40)));
    return;
  }
  if (!std::getline(in_, value)) {
    fail("the file ends within a group");
    return;
  }
  ++line_;
  now_.value = trimmed(value);
}

void DxfGroups::fail(const std::string& what) {
  if (error_.empty()) {
    error_ = fmt::format("{}:{}: {}; export it again as DXF (text)", file_, now_.line, what);
  }
  ended_ = true;
}

std::string DxfGroups::text() {
  const bool is_windows = !is_utf8(now_.value);
  has_windows_text_ = has_windows_text_ || is_windows;
  const std::string text = is_windows ? from_windows_1252(now_.value) : now_.value;
  std::string decoded;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view escape = std::string_view(text).substr(at, kEscape.size() + 4);
    const std::string_view digits = escape.substr(std::min(kEscape.size(), escape.size()));
    std::uint32_t code = 0;
    if (escape.starts_with(kEscape) && digits.size() == 4 &&
        std::from_chars(digits.data(), digits.data() + 4, code, 16).ptr == digits.data() + 4) {
      append_utf8(code, decoded);
      at += escape.size();
    } else {
      decoded += text[at++];
    }
  }
  return decoded;
}

double DxfGroups::number() {
  double number = 0.0;
  const std::string& text = now_.value;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
    fail(fmt::format("'{}' is no number", text.substr(0, 40)));
  }
  return number;
}

int DxfGroups::integer() {
  const double value = number();
  if (!(std::abs(value) < kMaxInteger)) {
    fail(fmt::format("'{}' is beyond the numbers of 16 bits of this group",
                     now_.value.substr(0, 40)));
    return 0;
  }
  return static_cast<int>(value);
}

bool DxfGroups::read_point(int x_code, FloorPoint& point) {
  if (now_.code != x_code && now_.code != x_code + 10) {
    return false;
  }
  point[now_.code == x_code ? 0 : 1] = number();
  return true;
}

}  // namespace rayloc
