#include "daemon/site/csv_table.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <system_error>
#include <utility>

namespace rayloc {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  return '"' + std::string(text.substr(0, kLongest)) + (text.size() > kLongest ? "...\"" : "\"");
}

}  // namespace

std::optional<Duration> parse_decimal_seconds(std::string_view text) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  // One second short of what Duration holds, so that the fraction always fits.
  constexpr std::int64_t kMostSeconds = std::numeric_limits<std::int64_t>::max() / kPerSecond - 1;
  const bool negative = !text.empty() && text.front() == '-';
  std::size_t at = !text.empty() && (negative || text.front() == '+') ? 1 : 0;
  const std::size_t first_digit = at;
  std::int64_t seconds = 0;
  for (; at < text.size() && is_digit(text[at]); ++at) {
    seconds = seconds * 10 + (text[at] - '0');
    if (seconds > kMostSeconds) {
      return std::nullopt;
    }
  }
  bool any_digit = at > first_digit;
  std::int64_t fraction = 0;
  if (at < text.size() && text[at] == '.') {
    ++at;
    std::int64_t unit = kPerSecond;
    for (; at < text.size() && is_digit(text[at]); ++at) {
      any_digit = true;
      if (unit > 1) {
        unit /= 10;
        fraction += unit * (text[at] - '0');
      } else if (unit == 1) {  // the tenth decimal rounds
        fraction += text[at] >= '5' ? 1 : 0;
        unit = 0;
      }
    }
  }
  if (!any_digit || at != text.size()) {
    return std::nullopt;
  }
  const std::int64_t total = seconds * kPerSecond + fraction;
  return Duration(negative ? -total : total);
}

Expected<CsvTable> CsvTable::load(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  // A directory can be opened too.
  if (!stream.is_open() || std::filesystem::is_directory(file, ignored)) {
    return bad_input(file.string() + ": cannot be read");
  }
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse(text, file.string());
}

Expected<CsvTable> CsvTable::parse(std::string_view text, std::string name) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    text.remove_prefix(kByteOrderMark.size());
  }
  CsvTable table;
  table.name_ = std::move(name);
  int line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = text.find('\n');
    std::string_view content = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!content.empty() && content.back() == '\r') {
      content.remove_suffix(1);
    }
    if (content.find_first_not_of(" \t") == std::string_view::npos) {
      continue;
    }
    Row row = split(content, line);
    if (table.header_.line == 0) {
      table.header_ = std::move(row);
    } else if (row.cells.size() != table.header_.cells.size()) {
      return bad_input(table.name_ + ":" + std::to_string(line) +
                       ":1: " + std::to_string(row.cells.size()) + " values, but the header has " +
                       std::to_string(table.header_.cells.size()) + " columns");
    } else {
      table.rows_.push_back(std::move(row));
    }
  }
  if (table.header_.line == 0) {
    return bad_input(table.name_ + ":1:1: empty; the first line names the columns");
  }
  return table;
}

CsvTable::Row CsvTable::split(std::string_view text, int line) {
  Row row;
  row.line = line;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    std::size_t first = begin;
    std::size_t last = comma;
    while (first < last && (text[first] == ' ' || text[first] == '\t')) {
      ++first;
    }
    while (last > first && (text[last - 1] == ' ' || text[last - 1] == '\t')) {
      --last;
    }
    row.cells.push_back({std::string(text.substr(first, last - first)), first + 1});
    if (comma == text.size()) {
      return row;
    }
    begin = comma + 1;
  }
}

std::optional<std::size_t> CsvTable::find_column(std::string_view name) const {
  for (std::size_t i = 0; i < header_.cells.size(); ++i) {
    if (header_.cells[i].text == name) {
      return i;
    }
  }
  return std::nullopt;
}

Expected<std::vector<std::size_t>> CsvTable::require(
    std::initializer_list<std::string_view> columns) const {
  std::vector<std::size_t> positions;
  std::string missing;
  std::string all;
  for (const std::string_view column : columns) {
    all.append(all.empty() ? "" : ",").append(column);
    if (const auto position = find_column(column)) {
      positions.push_back(*position);
    } else {
      missing.append(missing.empty() ? "" : ", ").append(column);
    }
  }
  if (!missing.empty()) {
    return bad_input(name_ + ":" + std::to_string(header_.line) + ":1: no column " + missing +
                     "; the first line names the columns: " + all);
  }
  return positions;
}

Expected<double> CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string& text = rows_[row].cells[column].text;
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return tl::make_unexpected(error_at(row, column, in_quotes(text) + " is not a number"));
  }
  return value;
}

Expected<Timestamp> CsvTable::time(std::size_t row, std::size_t column) const {
  const std::string& text = rows_[row].cells[column].text;
  const auto seconds = parse_decimal_seconds(text);
  if (!seconds) {
    return tl::make_unexpected(
        error_at(row,
                 column,
                 in_quotes(text) + " is not a time; write seconds since 1970 as a decimal number"));
  }
  return Timestamp(*seconds);
}

Error CsvTable::error_at(std::size_t row, std::size_t column, const std::string& what) const {
  return {ErrorKind::kBadInput,
          name_ + ":" + std::to_string(rows_[row].line) + ":" +
              std::to_string(rows_[row].cells[column].column) + ": " + what};
}

}  // namespace rayloc
