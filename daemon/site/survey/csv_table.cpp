#include "daemon/site/survey/csv_table.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

namespace rayloc {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

constexpr std::size_t kMaxBytes = 64U << 20U;
constexpr std::size_t kMaxRows = 1'000'000;
constexpr std::size_t kMaxColumns = 256;

std::string in_small_letters(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return result;
}

// Number of cells up to the last one that is not empty.
std::size_t filled(const CsvReader::Record& record) {
  std::size_t count = record.size();
  while (count > 0 && record[count - 1].empty()) {
    --count;
  }
  return count;
}

std::string too_long(const std::string& name) {
  return name + ": longer than " + std::to_string(kMaxBytes >> 20U) +
         " MiB: is this the file that you mean? Give it in parts";
}

}  // namespace

std::optional<Duration> parse_decimal_seconds(std::string_view text) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  // One second less than the maximum of Duration, so that the fraction always fits.
  constexpr std::int64_t kMaxSeconds = std::numeric_limits<std::int64_t>::max() / kPerSecond - 1;
  const bool negative = !text.empty() && text.front() == '-';
  std::size_t at = !text.empty() && (negative || text.front() == '+') ? 1 : 0;
  const std::size_t first_digit = at;
  std::int64_t seconds = 0;
  for (; at < text.size() && is_digit(text[at]); ++at) {
    seconds = seconds * 10 + (text[at] - '0');
    if (seconds > kMaxSeconds) {
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
  // Opening a directory succeeds as well.
  if (!stream.is_open() || std::filesystem::is_directory(file, ignored)) {
    return bad_input(file.string() + ": cannot be read");
  }
  // The length of a pipe is unknown in advance.
  std::string text;
  constexpr std::size_t kBlock = 64U << 10U;
  while (stream && text.size() <= kMaxBytes) {
    const std::size_t size = text.size();
    text.resize(size + kBlock);
    stream.read(&text[size], static_cast<std::streamsize>(kBlock));
    text.resize(size + static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) {
    return bad_input(file.string() + ": cannot be read");
  }
  return parse(text, file.string());
}

Expected<CsvTable> CsvTable::parse(std::string_view text, std::string name) {
  if (text.size() > kMaxBytes) {
    return bad_input(too_long(name));
  }
  CsvTable table;
  table.name_ = std::move(name);
  CsvReader reader(text, table.name_, ErrorKind::kBadInput, kMaxColumns);
  CsvReader::Record record;
  while (true) {
    const auto more = reader.next(record);
    RAYLOC_TRY(more);
    if (!*more) {
      break;
    }
    if (filled(record) == 0) {
      continue;
    }
    RAYLOC_TRY(table.add_row(record));
  }
  if (table.columns_.empty()) {
    return bad_input(table.name_ + ":1:1: empty; the first line names the columns");
  }
  table.separator_ = reader.separator();
  return table;
}

// The first record is the header.
Expected<void> CsvTable::add_row(const CsvReader::Record& record) {
  const auto place = [&] { return name_ + ":" + std::to_string(record.cells[0].line) + ":1: "; };
  if (columns_.empty()) {
    header_line_ = record.cells[0].line;
    for (std::size_t i = 0; i < filled(record); ++i) {
      columns_.push_back(in_small_letters(record[i]));
    }
    return {};
  }
  if (record.size() < columns_.size() || filled(record) > columns_.size()) {
    return bad_input(place() + std::to_string(record.size()) + " values, but the header has " +
                     std::to_string(columns_.size()) + " columns");
  }
  if (rows() == kMaxRows) {
    return bad_input(place() + "more than " + std::to_string(kMaxRows) +
                     " rows: is this the file that you mean? Give it in parts");
  }
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const CsvReader::Record::Cell& cell = record.cells[i];
    cells_.push_back({static_cast<std::uint32_t>(texts_.size()),
                      static_cast<std::uint32_t>(record[i].size()),
                      cell.line,
                      cell.column});
    texts_.append(record[i]);
  }
  return {};
}

std::optional<std::size_t> CsvTable::find_column(std::string_view name) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  return found == columns_.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - columns_.begin()));
}

Expected<std::vector<std::size_t>> CsvTable::require(
    std::initializer_list<std::string_view> columns) const {
  const auto place = [&] { return name_ + ":" + std::to_string(header_line_) + ":1: "; };
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
    if (std::count(columns_.begin(), columns_.end(), column) > 1) {
      return bad_input(place() + "two columns are called " + std::string(column) +
                       "; rename the one that is not meant");
    }
  }
  if (!missing.empty()) {
    return bad_input(place() + "no column " + missing +
                     "; the first line names the columns: " + all);
  }
  return positions;
}

Expected<double> CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string_view cell = text(row, column);
  const auto value = parse_csv_number(cell, separator_);
  if (!value) {
    return tl::make_unexpected(error_at(row, column, quoted_cell(cell) + " is not a number"));
  }
  return *value;
}

Expected<Timestamp> CsvTable::time(std::size_t row, std::size_t column) const {
  const std::string_view cell = text(row, column);
  const auto seconds = parse_decimal_seconds(with_decimal_point(cell, separator_));
  if (!seconds) {
    // A spreadsheet has rounded it, and the digits are lost.
    const bool rounded = parse_csv_number(cell, separator_).has_value();
    return tl::make_unexpected(error_at(
        row,
        column,
        quoted_cell(cell) + " is not a time; write seconds since 1970 as a decimal number" +
            (rounded ? " with all its digits, not as a spreadsheet rounds it" : "")));
  }
  return Timestamp(*seconds);
}

Error CsvTable::error_at(std::size_t row, std::size_t column, const std::string& what) const {
  const Cell& cell = cell_at(row, column);
  return {
      ErrorKind::kBadInput,
      name_ + ":" + std::to_string(cell.line) + ":" + std::to_string(cell.column) + ": " + what};
}

}  // namespace rayloc
