#include "daemon/lab/calibrate/report/introduction.h"

#include "daemon/lab/draw/html.h"

namespace rayloc {

std::string introduction(const std::string& sentence, const std::vector<std::string>& steps) {
  std::string html = "<p><strong>" + draw::html_text(sentence) + "</strong></p>\n";
  if (steps.empty()) {
    return html;
  }
  html += draw::html_paragraph("Recommended next steps:") + "<ol>\n";
  for (const std::string& one : steps) {
    html += "<li>" + draw::html_text(one) + "</li>\n";
  }
  return html + "</ol>\n";
}

}  // namespace rayloc
