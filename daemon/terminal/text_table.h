// TextTable: rows of cells as lines of aligned text.
//
// A cell is as wide as it has characters (UTF-8 code points). Thread safety: a plain value.
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
  // A title that begins with '>' (not shown) is of a column aligned to the right.
  explicit TextTable(std::vector<std::string> titles);

  // REQUIRES: as many cells as titles.
  void add(std::vector<std::string> cells);
  std::size_t rows() const { return rows_.size() - 1; }

  // Columns, by their titles, that may be left out where there is no room for all, the first first.
  void may_lack(std::vector<std::string> titles) { may_lack_ = std::move(titles); }

  // The titles, then the rows; no space at the ends of lines. As many columns as fit into `width`
  // characters; those that must not be left out may need more.
  std::vector<std::string> lines(std::size_t width = kAnyWidth) const;

 private:
  std::vector<std::size_t> shown_within(std::size_t width,
                                        const std::vector<std::size_t>& widths) const;

  std::vector<bool> is_right_;
  std::vector<std::string> may_lack_;
  std::vector<std::vector<std::string>> rows_;  // the titles first
};

// In characters.
std::size_t text_width(std::string_view text);
// As lines of at most `width` characters, broken at spaces; those after the first are indented.
std::vector<std::string> wrapped(const std::string& text, std::size_t width, std::size_t indent);
// At most `width` characters.
std::string cut(std::string text, std::size_t width);

}  // namespace rayloc::cli
