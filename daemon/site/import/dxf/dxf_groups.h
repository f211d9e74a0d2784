// DxfGroups: the groups of a DXF file as text, each of which is a line with a code and a line with
// its value.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "engine/base/outline.h"

namespace rayloc {

struct DxfGroup {
  int code = -1;
  std::string value;
  std::size_t line = 0;  // line number of the code
};

// An error ends the file: the functions below are safe after it.
class DxfGroups {
 public:
  explicit DxfGroups(const std::filesystem::path& file);

  const DxfGroup& now() const { return now_; }
  bool is(int code, std::string_view value) const {
    return now_.code == code && now_.value == value;
  }
  bool has_ended() const { return ended_; }
  // True where the next entity begins, too.
  bool is_end() const { return ended_ || now_.code == 0; }
  // With file and line; empty: none.
  const std::string& error() const { return error_; }
  void next();
  // The value as UTF-8, for names: "\U+00C4" is a letter, and bytes that are no UTF-8 are those of
  // Windows-1252.
  std::string text();
  // True if text() read such bytes.
  bool has_windows_text() const { return has_windows_text_; }
  // The value as a number. Notes an error if it is none.
  double number();
  // The same of a whole number of 16 bits.
  int integer();
  // Reads the current group if it is a coordinate of the point whose x has this code, and its y
  // that code + 10. False: it is another group.
  bool read_point(int x_code, FloorPoint& point);

 private:
  void fail(const std::string& what);

  std::string file_;
  std::ifstream in_;
  DxfGroup now_;
  std::size_t line_ = 0;
  bool ended_ = false;
  bool has_windows_text_ = false;
  std::string error_;
};

}  // namespace rayloc
