#include "engine/base/csv_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/number_text.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_line_end(char c) { return c == '\n' || c == '\r'; }

// Null bytes occur only in UTF-16, and these marks never in UTF-8.
bool is_utf16(std::string_view text) {
  const std::string_view mark = text.substr(0, 2);
  return mark == "\xff\xfe" || mark == "\xfe\xff" ||
         text.substr(0, 64).find('\0') != std::string_view::npos;
}

// The most frequent separator in the first line, outside of quotes.
char separator_of(std::string_view text) {
  // RFC 4180 has the comma; spreadsheets also write the others.
  constexpr std::array<char, 3> kSeparators = {',', ';', '\t'};
  std::array<std::size_t, 3> counts{};
  bool quoted = false;
  for (const char c : text) {
    if (is_line_end(c) && !quoted) {
      break;
    }
    quoted = quoted != (c == '"');
    for (std::size_t i = 0; !quoted && i < kSeparators.size(); ++i) {
      counts.at(i) += c == kSeparators.at(i) ? 1U : 0U;
    }
  }
  const auto most = std::max_element(counts.begin(), counts.end()) - counts.begin();
  return kSeparators.at(static_cast<std::size_t>(most));
}

}  // namespace

CsvReader::CsvReader(std::string_view text,
                     std::string name,
                     ErrorKind kind,
                     std::size_t most_cells)
    : text_(text), name_(std::move(name)), kind_(kind), most_cells_(most_cells) {
  // U+FEFF in UTF-8: some spreadsheets begin with it.
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text_.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    text_.remove_prefix(kByteOrderMark.size());
  }
}

tl::unexpected<Error> CsvReader::error_at(int line,
                                          std::size_t column,
                                          const std::string& what) const {
  return make_error(
      kind_, name_ + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + what);
}

bool CsvReader::skip_line_end() {
  if (at_ >= text_.size() || !is_line_end(text_[at_])) {
    return false;
  }
  at_ += text_.substr(at_, 2) == "\r\n" ? 2U : 1U;
  line_begin_ = at_;
  ++line_;
  return true;
}

void CsvReader::skip_lines_without_cells() {
  while (at_ < text_.size()) {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const std::string_view line = text_.substr(at_, end - at_);
    // A column may be called "#".
    const bool comment = line.substr(0, 1) == "#" &&
                         line.substr(1, 1).find_first_of(",;\t") == std::string_view::npos;
    if (!comment && line.find_first_not_of(" \t") != std::string_view::npos) {
      return;
    }
    at_ = end;
    skip_line_end();
  }
}

// Spreadsheets accept "sep=;" before the header.
void CsvReader::read_separator() {
  // A line that spreadsheets write before the header.
  constexpr std::string_view kStatedSeparator = "sep=";
  const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
  const std::string_view line = text_.substr(at_, end - at_);
  if (line.size() == kStatedSeparator.size() + 1 &&
      line.substr(0, kStatedSeparator.size()) == kStatedSeparator) {
    separator_ = line.back();
    at_ = end;
    skip_line_end();
    skip_lines_without_cells();
  } else {
    separator_ = separator_of(text_.substr(at_));
  }
}

bool CsvReader::at_end_of_cell() const {
  return at_ >= text_.size() || text_[at_] == separator_ || is_line_end(text_[at_]);
}

void CsvReader::add(Record& record, std::size_t begin, std::size_t end) const {
  record.text.append(text_.substr(begin, end - begin));
}

void CsvReader::read_plain(Record& record) {
  const std::size_t begin = at_;
  while (!at_end_of_cell()) {
    ++at_;
  }
  std::size_t end = at_;
  while (end > begin && is_blank(text_[end - 1])) {
    --end;
  }
  add(record, begin, end);
}

// Reads a quoted cell from its first quote.
Expected<void> CsvReader::read_quoted(Record& record) {
  const int line = line_;
  const std::size_t first = column();
  ++at_;
  while (true) {
    const std::size_t end = text_.find_first_of("\"\r\n", at_);
    if (end == std::string_view::npos) {
      return error_at(line, first, "this quote is never closed; write \" at the end of the cell");
    }
    add(record, at_, end);
    at_ = end;
    if (is_line_end(text_[at_])) {
      const std::size_t begin = at_;
      skip_line_end();
      add(record, begin, at_);
    } else if (text_.substr(at_, 2) == "\"\"") {
      record.text += '"';
      at_ += 2;
    } else {
      ++at_;
      break;
    }
  }
  while (!at_end_of_cell() && is_blank(text_[at_])) {
    ++at_;
  }
  if (!at_end_of_cell()) {
    return error_at(
        line_, column(), "text after a closing quote; a quote within one is written \"\"");
  }
  return {};
}

Expected<void> CsvReader::read_cell(Record& record) {
  while (!at_end_of_cell() && is_blank(text_[at_])) {
    ++at_;
  }
  Record::Cell cell{0, line_, static_cast<std::uint32_t>(column())};
  if (record.cells.size() == most_cells_) {
    return error_at(
        line_, column(), "more than " + std::to_string(most_cells_) + " cells in a line");
  }
  if (at_ < text_.size() && text_[at_] == '"') {
    RAYLOC_TRY(read_quoted(record));
  } else {
    read_plain(record);
  }
  cell.end = static_cast<std::uint32_t>(record.text.size());
  record.cells.push_back(cell);
  return {};
}

Expected<bool> CsvReader::next(Record& record) {
  record.text.clear();
  record.cells.clear();
  if (at_ == 0 && is_utf16(text_)) {
    return error_at(1, 1, "UTF-16, or no text; save it as \"CSV UTF-8\"");
  }
  skip_lines_without_cells();
  if (separator_ == '\0') {
    read_separator();
  }
  if (at_ >= text_.size()) {
    return false;
  }
  while (true) {
    RAYLOC_TRY(read_cell(record));
    if (at_ >= text_.size() || skip_line_end()) {
      return true;
    }
    ++at_;  // the separator
  }
}

std::string with_decimal_point(std::string_view text, char separator) {
  std::string result(text);
  const bool decimal_comma = separator != ',' && text.find('.') == std::string_view::npos &&
                             std::count(text.begin(), text.end(), ',') == 1;
  if (decimal_comma) {
    result[result.find(',')] = '.';
  }
  return result;
}

std::optional<double> parse_csv_number(std::string_view text, char separator) {
  const std::string number = with_decimal_point(text, separator);
  std::string_view rest = number;
  const std::optional<double> value = read_number(rest);
  if (!value || !rest.empty() || !std::isfinite(*value)) {
    return std::nullopt;
  }
  return value;
}

std::string quoted_cell(std::string_view text) {
  constexpr std::size_t kLongest = 40;  // [characters] of a cell, chosen: an error stays one line
  return '"' + printable(std::string(text.substr(0, kLongest))) +
         (text.size() > kLongest ? "...\"" : "\"");
}

}  // namespace rayloc
