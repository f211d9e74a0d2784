// TextTable: rows of cells as lines of aligned text.
//
// The width of a cell is its number of UTF-8 code points. Thread safety: a plain value.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rayloc::cli {

constexpr std::size_t kAnyWidth = std::string::npos;

class TextTable {
 public:
  // A title that begins with '>' (not shown) marks a right-aligned column.
  explicit TextTable(std::vector<std::string> titles);

  // REQUIRES: as many cells as titles.
  void add(std::vector<std::string> cells);
  std::size_t rows() const { return rows_.size() - 1; }

  // Columns, by title, that may be dropped if the width is too small; the first is dropped first.
  void may_lack(std::vector<std::string> titles) { may_lack_ = std::move(titles); }

  // The titles, then the rows; no space at the ends of lines. As many columns as fit into `width`
  // characters; the required columns may need more.
  std::vector<std::string> lines(std::size_t width = kAnyWidth) const;

 private:
  std::vector<std::size_t> shown_within(std::size_t width,
                                        const std::vector<std::size_t>& widths) const;

  std::vector<bool> is_right_;
  std::vector<std::string> may_lack_;
  std::vector<std::vector<std::string>> rows_;  // titles first
};

// In characters.
std::size_t text_width(std::string_view text);
// Lines of at most `width` characters, broken at spaces; lines after the first are indented.
std::vector<std::string> wrapped(const std::string& text, std::size_t width, std::size_t indent);
// Truncates to at most `width` characters.
std::string cut(std::string text, std::size_t width);

}  // namespace rayloc::cli
