// Pieces of a page of HTML that is well-formed XML as well.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rayloc::draw {

// Text with the characters escaped that mean something, in elements and attributes of HTML and SVG;
// control characters, most of which XML has no way to write, become "?".
std::string html_text(std::string_view text);

struct HtmlTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // plain text, one cell a column
};

std::string to_html(const HtmlTable& table);

// A whole page; `body` is HTML, `title` plain text.
std::string html_page(std::string_view title, std::string_view body);

}  // namespace rayloc::draw
