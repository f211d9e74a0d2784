#include "daemon/lab/draw/html.h"

#include <spdlog/fmt/fmt.h>

namespace rayloc::draw {
namespace {

// Pictures are drawn for a white page; in dark mode they are inverted, with hues kept.
constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --ink: #222; --page: #fff; --line: #d5d5d5; --faint: #666; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #ddd; --page: #141414; --line: #3c3c3c; --faint: #999; }
  svg { filter: invert(0.92) hue-rotate(180deg); }
}
body { margin: 2rem auto; padding: 0 1rem; max-width: 68rem; color: var(--ink);
  background: var(--page); font: 15px/1.5 "DejaVu Sans", Verdana, sans-serif; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
p { max-width: 46rem; } .faint { color: var(--faint); }
.figures { display: flex; flex-wrap: wrap; gap: 1rem; }
svg { max-width: 100%; height: auto; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { padding: 0.2rem 0.8rem 0.2rem 0; text-align: left; border-bottom: 1px solid var(--line); }
)";

}  // namespace

std::string html_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    }
  }
  return result;
}

std::string html_paragraph(std::string_view text) { return "<p>" + html_text(text) + "</p>\n"; }

std::string html_section(std::string_view heading, std::string_view body) {
  return fmt::format("<h2>{}</h2>\n{}", html_text(heading), body);
}

std::string to_html(const HtmlTable& table) {
  std::string html = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const std::string& column : table.columns) {
    html += "<th>" + html_text(column) + "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) {
      html += "<td>" + html_text(cell) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string html_page(std::string_view title, std::string_view body) {
  return fmt::format(
      "<!DOCTYPE html>\n"
      "<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{2}</body>\n</"
      "html>\n",
      html_text(title),
      kStyle,
      body);
}

}  // namespace rayloc::draw
