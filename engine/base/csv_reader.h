// CsvReader: reads the records of a table as text, one after another, as scripts, spreadsheets and
// people write them. The caller interprets the cells.
//
// RFC 4180: cells in quotes hold separators, line ends and "" for a quote. Beyond it: blanks around
// cells; LF, CRLF or CR; a byte order mark; semicolons or tabs for commas (by the first line, or
// "sep=;" before it); empty lines and lines that begin with '#' are skipped. UTF-16 is refused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

class CsvReader {
 public:
  // The cells of a record; their texts are concatenated, so that a cell takes few bytes.
  struct Record {
    struct Cell {
      std::uint32_t end = 0;     // end in `text`; the start is the previous end
      std::int32_t line = 0;     // of the file, from 1
      std::uint32_t column = 0;  // byte in the line, from 1
    };
    std::string text;
    std::vector<Cell> cells;

    std::size_t size() const { return cells.size(); }
    std::string_view operator[](std::size_t cell) const {
      const std::size_t begin = cell == 0 ? 0 : cells[cell - 1].end;
      return std::string_view(text).substr(begin, cells[cell].end - begin);
    }
  };

  // `name` denotes the file in errors, which are of `kind`. A record with more than `most_cells`
  // cells is an error. REQUIRES: `text` outlives the reader and is shorter than 4 GiB.
  CsvReader(std::string_view text, std::string name, ErrorKind kind, std::size_t most_cells);

  // Replaces `record` by the next one; false at the end. Errors: "NAME:LINE:COLUMN: message".
  Expected<bool> next(Record& record);

  // ',', ';' or a tab; set after the first record.
  char separator() const { return separator_; }

 private:
  bool skip_line_end();
  void skip_lines_without_cells();
  void read_separator();
  Expected<void> read_cell(Record& record);
  Expected<void> read_quoted(Record& record);
  void read_plain(Record& record);
  void add(Record& record, std::size_t begin, std::size_t end) const;
  bool at_end_of_cell() const;
  std::size_t column() const { return at_ - line_begin_ + 1; }
  tl::unexpected<Error> error_at(int line, std::size_t column, const std::string& what) const;

  std::string_view text_;
  std::string name_;
  ErrorKind kind_;
  std::size_t most_cells_;
  std::size_t at_ = 0;
  std::size_t line_begin_ = 0;
  int line_ = 1;
  char separator_ = '\0';  // not yet determined
};

// A number as a table with that separator writes it: where the separator is no comma, a comma may
// be the decimal point ("1,25"). Nothing where it is no number, or not finite.
std::optional<double> parse_csv_number(std::string_view text, char separator);
// The same text with a point as decimal separator.
std::string with_decimal_point(std::string_view text, char separator);

// The beginning of a cell for a message: in quotes, without control characters.
std::string quoted_cell(std::string_view text);

}  // namespace rayloc
