// CsvTable: a comma-separated file with a header line, as surveys are written by hand, by scripts
// and by spreadsheets. Columns are found by name, in any order and case; others are ignored.
//
// csv_reader.h defines the accepted separators, quotes, line ends and comments. Rows without any
// value, and empty cells beyond the header, as spreadsheets write them, are left out. Errors name
// file:line:column. A file beyond 64 MiB or a million rows is rejected before it is in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/csv_reader.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Converts a decimal number of seconds ("1718000125.3680", "-0.5") to the nearest nanosecond, by
// integer arithmetic: a double since the epoch is 240 ns off. Empty if it is no such number, or
// beyond the year 2262.
std::optional<Duration> parse_decimal_seconds(std::string_view text);

class CsvTable {
 public:
  static Expected<CsvTable> load(const std::filesystem::path& file);
  // `name` denotes the file in errors.
  static Expected<CsvTable> parse(std::string_view text, std::string name);

  bool has_column(std::string_view name) const { return find_column(name).has_value(); }
  // The positions of these columns, in their order; an Error that lists the missing ones.
  Expected<std::vector<std::size_t>> require(std::initializer_list<std::string_view> columns) const;

  std::size_t rows() const { return cells_.size() / columns_.size(); }
  int line(std::size_t row) const { return cell_at(row, 0).line; }
  // ',' unless the file uses another one.
  char separator() const { return separator_; }

  std::string_view text(std::size_t row, std::size_t column) const {
    const Cell& cell = cell_at(row, column);
    return std::string_view(texts_).substr(cell.begin, cell.size);
  }
  Expected<double> number(std::size_t row, std::size_t column) const;
  // Converts seconds since 1970 to a time.
  Expected<Timestamp> time(std::size_t row, std::size_t column) const;

  // Returns an Error located at that cell.
  Error error_at(std::size_t row, std::size_t column, const std::string& what) const;

 private:
  struct Cell {               // 32 bits each: a file is shorter than 4 GiB
    std::uint32_t begin = 0;  // offset in texts_
    std::uint32_t size = 0;
    std::int32_t line = 0;     // from 1
    std::uint32_t column = 0;  // byte in the line, from 1
  };

  Expected<void> add_row(const CsvReader::Record& record);
  const Cell& cell_at(std::size_t row, std::size_t column) const {
    return cells_[row * columns_.size() + column];
  }
  std::optional<std::size_t> find_column(std::string_view name) const;

  std::string name_;
  char separator_ = ',';
  int header_line_ = 1;
  std::vector<std::string> columns_;  // names in lower case
  std::vector<Cell> cells_;           // row by row
  std::string texts_;                 // contents of all cells
};

}  // namespace rayloc
