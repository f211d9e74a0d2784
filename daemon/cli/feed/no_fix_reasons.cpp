#include "daemon/cli/feed/no_fix_reasons.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace rayloc::cli {
namespace {

// Removes the numbers that grow from burst to burst, so that they form one reason.
std::string without_progress(std::string reason) {
  constexpr std::string_view kBegin = "learning the chains of ";
  for (std::size_t at = reason.find(kBegin); at != std::string::npos;
       at = reason.find(kBegin, at + 1)) {
    const std::size_t colon = std::min(reason.find(':', at), reason.size());
    reason.erase(colon, std::min(reason.find(';', colon), reason.size()) - colon);
  }
  return reason;
}

}  // namespace

void NoFixReasons::count(const Location& location) {
  if (location.is_filtered() || location.estimate.position) {
    return;
  }
  const std::string reason = without_progress(location.estimate.reason);
  ++all_;
  if (counts_.size() < kReasons || counts_.count(reason) > 0) {
    ++counts_[reason];
  }
}

std::string NoFixReasons::text() const {
  if (all_ == 0) {
    return {};
  }
  std::vector<std::pair<std::string, std::uint64_t>> most(counts_.begin(), counts_.end());
  std::stable_sort(
      most.begin(), most.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  std::uint64_t others = all_;
  for (const auto& [reason, count] : most) {
    text += (text.empty() ? "" : "; ") + reason + " (" + std::to_string(count) + ")";
    others -= count;
  }
  if (others > 0) {
    text += "; other reasons (" + std::to_string(others) + ")";
  }
  return std::to_string(all_) + " without a fix: " + text;
}

}  // namespace rayloc::cli
