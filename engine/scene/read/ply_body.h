// PlyBody: the numbers of a PLY file's body, one after the other, in any encoding.
// Internal to read_ply.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "engine/scene/read/ply_header.h"

namespace rayloc {

class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header);

  // Nothing at the end of the bytes or where there is no number.
  std::optional<double> next(PlyType type) {
    return encoding_ == PlyEncoding::kAscii ? next_text() : next_binary(type);
  }
  bool is_text() const { return encoding_ == PlyEncoding::kAscii; }
  std::size_t bytes_left() const { return bytes_.size() - at_; }
  // Text of the last number; empty in a binary file.
  std::string_view text() const { return text_; }
  // True if the last number is the first of its line of text.
  bool begins_line() const { return begins_line_; }
  // True if only blanks are left, or the padding at the end of some files.
  bool is_at_end() const;
  // Place of the next byte: ":12", ": byte 40".
  std::string place() const;

 private:
  std::optional<double> next_text();
  std::optional<double> next_binary(PlyType type);
  template <typename T>
  double decode();

  std::string_view bytes_;
  std::string_view text_;
  PlyEncoding encoding_;
  std::size_t at_;
  std::size_t end_;  // end without the padding
  std::size_t line_;
  bool begins_line_ = false;
};

}  // namespace rayloc
