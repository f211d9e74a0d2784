// Parts of an HTML page that is also well-formed XML.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rayloc::draw {

// Text with special characters escaped, for elements and attributes of HTML and SVG; control
// characters, most of which XML cannot represent, become "?".
std::string html_text(std::string_view text);

// A paragraph of plain text.
std::string html_paragraph(std::string_view text);

// A heading of plain text, and `body` as HTML.
std::string html_section(std::string_view heading, std::string_view body);

struct HtmlTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // plain text, one cell per column
};

std::string to_html(const HtmlTable& table);

// A whole page; `body` is HTML, `title` plain text.
std::string html_page(std::string_view title, std::string_view body);

}  // namespace rayloc::draw
