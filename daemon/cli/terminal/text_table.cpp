#include "daemon/cli/terminal/text_table.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/base/check.h"

namespace rayloc::cli {
namespace {

constexpr std::string_view kBetween = "  ";

// True if the byte begins a character.
bool begins(char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }

}  // namespace

std::size_t text_width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins));
}

std::string cut(std::string text, std::size_t width) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (begins(text[i]) && width-- == 0) {
      text.resize(i);
      break;
    }
  }
  return text;
}

std::vector<std::string> wrapped(const std::string& text, std::size_t width, std::size_t indent) {
  std::vector<std::string> lines;
  std::string rest = text;
  while (text_width(rest) > width) {
    const std::string piece = cut(rest, width + 1);
    const std::size_t space = piece.rfind(' ');
    // Not within the indentation, since that would not shorten the line.
    if (space == std::string::npos || piece.find_last_not_of(' ', space) == std::string::npos) {
      break;
    }
    lines.push_back(rest.substr(0, space));
    rest = std::string(indent, ' ') + rest.substr(space + 1);
  }
  lines.push_back(rest);
  return lines;
}

TextTable::TextTable(std::vector<std::string> titles) {
  for (std::string& title : titles) {
    is_right_.push_back(title.starts_with('>'));
    title.erase(0, is_right_.back() ? 1 : 0);
  }
  rows_.push_back(std::move(titles));
}

void TextTable::add(std::vector<std::string> cells) {
  RAYLOC_CHECK(cells.size() == is_right_.size());
  rows_.push_back(std::move(cells));
}

// Indices of the columns.
std::vector<std::size_t> TextTable::shown_within(std::size_t width,
                                                 const std::vector<std::size_t>& widths) const {
  std::vector<std::size_t> shown(widths.size());
  std::iota(shown.begin(), shown.end(), std::size_t{0});
  const auto needed = [&] {
    std::size_t sum = 0;
    for (const std::size_t i : shown) {
      sum += widths[i] + (sum == 0 ? 0 : kBetween.size());
    }
    return sum;
  };
  for (auto title = may_lack_.begin(); title != may_lack_.end() && needed() > width; ++title) {
    std::erase_if(shown, [&](std::size_t i) { return rows_.front()[i] == *title; });
  }
  return shown;
}

std::vector<std::string> TextTable::lines(std::size_t width) const {
  std::vector<std::size_t> widths(is_right_.size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], text_width(row[i]));
    }
  }
  const std::vector<std::size_t> shown = shown_within(width, widths);
  std::vector<std::string> lines;
  for (const auto& row : rows_) {
    std::string line;
    for (const std::size_t i : shown) {
      const std::string padding(widths[i] - text_width(row[i]), ' ');
      line += (i == shown.front() ? "" : std::string(kBetween)) +
              (is_right_[i] ? padding + row[i] : row[i] + padding);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace rayloc::cli
