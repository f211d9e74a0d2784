#include "engine/base/suggestion.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <vector>

namespace rayloc {
namespace {

// Removes differences that do not count: case, '_', '-', ' '.
std::string plain(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c != '_' && c != '-' && c != ' ') {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return result;
}

// Number of insertions, deletions, replacements and swaps of neighbours that turn `b` into `a`
// (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    last[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

constexpr std::size_t kLongestWord = 64;  // longer words are no mistyped names, and cost time
// A count of letters, chosen: two letters occur in too many names.
constexpr std::size_t kShortestAbbreviation = 3;

}  // namespace

std::string_view closest_name(std::string_view word, std::span<const std::string_view> names) {
  const std::string wanted = plain(word);
  if (wanted.empty() || wanted.size() > kLongestWord) {
    return {};
  }
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(1, (wanted.size() + 1) / 3) + 1;
  for (const std::string_view name : names) {
    const std::size_t distance = edit_distance(wanted, plain(name));
    // With as many changes as letters nothing of the word is left.
    if (distance < best_distance && distance < wanted.size()) {
      best = name;
      best_distance = distance;
    }
  }
  if (!best.empty() || wanted.size() < kShortestAbbreviation) {
    return best;
  }
  for (const std::string_view name : names) {
    const std::string known = plain(name);
    if (known.find(wanted) != std::string::npos ||
        (known.size() >= kShortestAbbreviation && wanted.find(known) != std::string::npos)) {
      if (!best.empty()) {
        return {};  // ambiguous: several names match
      }
      best = name;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string_view> names) {
  if (names.empty()) {
    return {};
  }
  const std::string_view close = closest_name(word, names);
  return close.empty() ? "; there are: " + list_of(names)
                       : "; did you mean '" + std::string(close) + "'?";
}

std::string list_of(std::span<const std::string_view> names) {
  std::string list;
  for (const std::string_view name : names) {
    list += list.empty() ? "" : ", ";
    list += name;
  }
  return list;
}

std::string suggestion(std::string_view word, std::span<const std::string> names) {
  const std::vector<std::string_view> views(names.begin(), names.end());
  return suggestion(word, std::span<const std::string_view>(views));
}

}  // namespace rayloc
