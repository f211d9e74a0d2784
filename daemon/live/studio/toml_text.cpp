#include "daemon/live/studio/toml_text.h"

#include <algorithm>
#include <utility>

#include "daemon/site/model/toml_reader.h"

namespace rayloc {
namespace {

bool is_table_list(const toml::node& node) {
  const toml::array* const array = node.as_array();
  return array != nullptr && !array->empty() && array->front().is_table() &&
         !array->front().as_table()->is_inline();
}

}  // namespace

Expected<TomlText> TomlText::parse(std::string text, const std::filesystem::path& file) {
  // Refuses input that toml++ cannot handle, and gives our own messages for invalid TOML.
  RAYLOC_TRY(TomlDocument::parse(text, file));
  toml::parse_result parsed = toml::parse(text);
  return TomlText(std::move(text), std::move(parsed));
}

TomlText::TomlText(std::string text, toml::table root)
    : text_(std::move(text)), root_(std::make_unique<toml::table>(std::move(root))) {
  lines_.push_back(0);
  for (std::size_t i = 0; i < text_.size(); ++i) {
    if (text_[i] == '\n') {
      lines_.push_back(i + 1);
    }
  }
}

// Columns count characters of UTF-8.
std::size_t TomlText::offset(const toml::source_position& position) const {
  const std::size_t line = std::min<std::size_t>(position.line, lines_.size());
  std::size_t at = line == 0 ? 0 : lines_[line - 1];
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (at == 0 && text_.starts_with(kMark)) {
    at = kMark.size();
  }
  for (toml::source_index column = 1; column < position.column && at < text_.size(); ++column) {
    ++at;
    while (at < text_.size() && (static_cast<unsigned char>(text_[at]) & 0xC0U) == 0x80U) {
      ++at;
    }
  }
  return at;
}

bool TomlText::has_header(const toml::table& table) const {
  const std::size_t at = offset(table.source().begin);
  return !table.is_inline() && table.source().begin.line > 0 && &table != root_.get() &&
         at < text_.size() && text_[at] == '[';
}

// Records the headers of the node and its descendants.
void TomlText::note_headers(const toml::node& node, std::vector<Header>& headers) const {
  if (const toml::table* const table = node.as_table(); table != nullptr) {
    if (has_header(*table)) {
      headers.push_back({offset(table->source().begin), table});
    }
    for (const auto& [key, child] : *table) {
      note_headers(child, headers);
    }
  } else if (is_table_list(node)) {
    for (const toml::node& child : *node.as_array()) {
      note_headers(child, headers);
    }
  }
}

std::size_t TomlText::line_begin(std::size_t at) const {
  return *std::prev(std::upper_bound(lines_.begin(), lines_.end(), at));
}

std::size_t TomlText::line_end(std::size_t at) const {
  const std::size_t end = text_.find('\n', at);
  return end == std::string::npos ? text_.size() : end + 1;
}

std::size_t TomlText::with_comments_above(std::size_t line) const {
  while (line > 0) {
    const std::size_t above = line_begin(line - 1);
    const std::size_t first = text_.find_first_not_of(" \t", above);
    if (first >= line || text_[first] != '#') {
      break;
    }
    line = above;
  }
  return line;
}

// Position after the last value below the table's own header; 0: none.
std::size_t TomlText::end_of_values(const toml::table& table) const {
  std::size_t end = 0;
  for (const auto& [key, node] : table) {
    const toml::table* const child = node.as_table();
    if (is_table_list(node) || (child != nullptr && has_header(*child))) {
      continue;
    }
    end = std::max(end,
                   child != nullptr && !child->is_inline() ? end_of_values(*child)  // a.b = 1
                                                           : offset(node.source().end));
  }
  return end;
}

std::size_t TomlText::end_of_own_lines(const toml::table& table) const {
  const std::size_t header = has_header(table) ? offset(table.source().begin) : 0;
  return line_end(std::max(header, end_of_values(table)));
}

Expected<void> TomlText::set(const toml::table& table,
                             std::string_view key,
                             const std::string& value) {
  if (const toml::node* const node = table.get(key); node != nullptr) {
    edits_.replace(offset(node->source().begin), offset(node->source().end), value);
    return {};
  }
  if (table.is_inline() || !has_header(table)) {
    return make_error(ErrorKind::kConfiguration,
                      "a table in braces cannot get the key '" + std::string(key) +
                          "' here; write it with a header, [[name]]");
  }
  const std::size_t at = end_of_own_lines(table);
  const std::size_t header = line_begin(offset(table.source().begin));
  const std::string indent = text_.substr(header, text_.find_first_not_of(" \t", header) - header);
  const std::string before = at > 0 && text_[at - 1] != '\n' ? "\n" : "";
  edits_.replace(at, at, before + indent + std::string(key) + " = " + value + "\n");
  return {};
}

void TomlText::erase(const toml::table& table, std::string_view key) {
  const toml::node* const node = table.get(key);
  if (node != nullptr && !table.is_inline()) {
    edits_.replace(
        line_begin(offset(node->source().begin)), line_end(offset(node->source().end)), "");
  }
}

Expected<void> TomlText::erase_table(const toml::table& table) {
  if (!has_header(table)) {
    return make_error(ErrorKind::kConfiguration,
                      "a table in braces cannot be taken out here; write it with a header, "
                      "[[name]]");
  }
  std::vector<Header> headers;
  note_headers(table, headers);
  for (const Header& header : headers) {
    const std::size_t begin = with_comments_above(line_begin(header.at));
    std::size_t end = end_of_own_lines(*header.table);
    while (end < text_.size() && text_.find_first_not_of(" \t\r", end) < text_.size() &&
           text_[text_.find_first_not_of(" \t\r", end)] == '\n') {
      end = line_end(end);
    }
    edits_.replace(begin, end, "");
  }
  return {};
}

void TomlText::append_after(const toml::table* table, const std::string& text) {
  std::size_t at = text_.size();
  if (table != nullptr && has_header(*table)) {
    at = 0;
    std::vector<Header> headers;
    note_headers(*table, headers);
    for (const Header& header : headers) {
      at = std::max(at, end_of_own_lines(*header.table));
    }
  }
  const bool open = at > 0 && text_[at - 1] != '\n';
  edits_.replace(at, at, (open ? "\n" : "") + text);
}

std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
    }
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace rayloc
