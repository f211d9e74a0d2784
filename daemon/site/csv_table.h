// CsvTable: a comma-separated file with a header line, as surveys are written by hand, by scripts
// and by spreadsheets. Columns are found by name, in any order; further ones are ignored.
//
// Accepted: LF or CRLF, a byte order mark, empty lines, blanks around cells. Quotes are not: no
// cell that we read needs them. Errors name file:line:column.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// A decimal number of seconds ("1718000125.3680", "-0.5") to the nearest nanosecond, by way of
// integers: a double since the epoch is 240 ns off. Nothing when it is not one, or beyond the year
// 2262.
std::optional<Duration> parse_decimal_seconds(std::string_view text);

class CsvTable {
 public:
  static Expected<CsvTable> load(const std::filesystem::path& file);
  // `name` stands for the file in errors.
  static Expected<CsvTable> parse(std::string_view text, std::string name);

  bool has_column(std::string_view name) const { return find_column(name).has_value(); }
  // The positions of these columns, in their order; an Error that says which are missing.
  Expected<std::vector<std::size_t>> require(std::initializer_list<std::string_view> columns) const;

  std::size_t rows() const { return rows_.size(); }
  int line(std::size_t row) const { return rows_[row].line; }

  const std::string& text(std::size_t row, std::size_t column) const {
    return rows_[row].cells[column].text;
  }
  Expected<double> number(std::size_t row, std::size_t column) const;
  // Seconds since 1970 as time.
  Expected<Timestamp> time(std::size_t row, std::size_t column) const;

  // An Error at that cell.
  Error error_at(std::size_t row, std::size_t column, const std::string& what) const;

 private:
  struct Cell {
    std::string text;
    std::size_t column = 0;  // byte in the line, from 1
  };
  struct Row {
    int line = 0;  // from 1
    std::vector<Cell> cells;
  };

  static Row split(std::string_view text, int line);
  std::optional<std::size_t> find_column(std::string_view name) const;

  std::string name_;
  Row header_;
  std::vector<Row> rows_;
};

}  // namespace rayloc
