// TomlText: edits a TOML text in place. Unchanged parts
// keep their bytes: comments, order, line ends, spaces.
//
//   auto text = TomlText::parse(bytes, file);
//   text->set(zone, "name", "\"desk\"");
//   text->append_after(last_zone, "\n[[zone]]\n...");
//   write(text->edited());
//
// Included only by .cpp files of this folder: it includes toml++.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "daemon/live/studio/text_edits.h"
#include "engine/base/expected.h"

namespace rayloc {

class TomlText {
 public:
  // Returns an Error with file:line:column if the text is no TOML.
  static Expected<TomlText> parse(std::string text, const std::filesystem::path& file);

  const toml::table& root() const { return *root_; }

  // Sets the value of the key to `value`, which is TOML; a missing key gets a line behind the
  // others of its table. Returns an Error for a table that is written on one line, {a = 1}.
  Expected<void> set(const toml::table& table, std::string_view key, const std::string& value);
  // Removes the line of the key, if there is one.
  void erase(const toml::table& table, std::string_view key);
  // Removes [[table]] with all tables below it and the comments right above their headers.
  Expected<void> erase_table(const toml::table& table);
  // Inserts behind all content of the table, or at the end of the text (null).
  void append_after(const toml::table* table, const std::string& text);

  std::string edited() const { return edits_.apply(text_); }

 private:
  struct Header {
    std::size_t at = 0;
    const toml::table* table = nullptr;
  };

  TomlText(std::string text, toml::table root);
  void note_headers(const toml::node& node, std::vector<Header>& headers) const;
  std::size_t offset(const toml::source_position& position) const;
  bool has_header(const toml::table& table) const;
  std::size_t line_begin(std::size_t at) const;
  std::size_t line_end(std::size_t at) const;  // position after its line end
  std::size_t with_comments_above(std::size_t line) const;
  std::size_t end_of_values(const toml::table& table) const;
  std::size_t end_of_own_lines(const toml::table& table) const;

  std::string text_;
  std::vector<std::size_t> lines_;     // begin of each line
  std::unique_ptr<toml::table> root_;  // its address stays the same when this is moved
  TextEdits edits_;
};

// A TOML string.
std::string toml_string(std::string_view text);

}  // namespace rayloc
