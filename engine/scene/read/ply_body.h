// PlyBody: the numbers of a PLY file's body, one after the other, in whichever encoding. Internal
// to read_ply.
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

  // Nothing at the end of the bytes or where no number is.
  std::optional<double> next(PlyType type) {
    return encoding_ == PlyEncoding::kAscii ? next_text() : next_binary(type);
  }
  bool is_text() const { return encoding_ == PlyEncoding::kAscii; }
  std::size_t bytes_left() const { return bytes_.size() - at_; }
  // How the newest number is written; empty in a binary file.
  std::string_view text() const { return text_; }
  // Whether the newest number is the first of its line of text.
  bool begins_line() const { return begins_line_; }
  // Whether blanks are left only, or the fill that follows some files.
  bool is_at_end() const;
  // Of the next byte: ":12", ": byte 40".
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
  std::size_t end_;  // of what is no fill
  std::size_t line_;
  bool begins_line_ = false;
};

}  // namespace rayloc
