// StepText: a STEP file (ISO 10303-21) split into its entities.
//
// Comments, line ends and spaces between tokens are left out. Encodings of strings are kept.
// Thread safety: const functions may be called from several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

struct StepEntity {
  std::uint64_t id = 0;         // #ID, from 1
  std::uint32_t line = 0;       // of the file, from 1
  std::uint32_t type_at = 0;    // [bytes], in the text
  std::uint32_t type_size = 0;  // 0: an instance of several types, "#1=(A()B())"
  std::uint32_t arguments_at = 0;
  std::uint32_t arguments_size = 0;
};

class StepText {
 public:
  // An Error (kBadInput) begins with "FILE:LINE: ": a file that ends early, an entity that is not
  // written as the standard requires, lists nested too deeply, two entities with one id.
  static Expected<StepText> parse(std::string_view bytes, const std::string& file);

  // The first of FILE_SCHEMA, in capitals; may be empty.
  const std::string& schema() const { return schema_; }
  const std::vector<StepEntity>& entities() const { return entities_; }  // in the file's order
  // The views are valid while this object exists and is not moved.
  std::string_view type(const StepEntity& entity) const {  // in capitals
    return std::string_view(text_).substr(entity.type_at, entity.type_size);
  }
  std::string_view arguments(const StepEntity& entity) const {  // with their parentheses
    return std::string_view(text_).substr(entity.arguments_at, entity.arguments_size);
  }
  // Index in entities().
  std::optional<std::size_t> find(std::uint64_t id) const;

 private:
  friend class StepWriter;
  Expected<void> add(std::size_t begin, std::uint32_t line, const std::string& place);
  void sort();
  Expected<void> check_ids(const std::string& file) const;

  std::string text_;
  std::string schema_;
  std::vector<StepEntity> entities_;
  std::vector<std::uint32_t> by_id_;  // indices, sorted by id
};

// Makes a StepText of entities that a program states.
class StepWriter {
 public:
  explicit StepWriter(std::string schema) { step_.schema_ = std::move(schema); }
  // `id`: above 0, and of no other entity. `line`: of the file, for messages. `arguments`: with
  // their parentheses.
  void add(std::uint64_t id, std::uint32_t line, std::string_view type, std::string_view arguments);
  std::size_t bytes() const { return step_.text_.size(); }
  StepText finish();

 private:
  StepText step_;
};

// At most 40 bytes of a text of the file, for a message; no character of UTF-8 is cut.
std::string clipped_step(std::string_view text);

// The position behind the string that begins at `at`.
std::size_t step_string_end(std::string_view text, std::size_t at);

// The items of a list "(A,(B,C),'D')"; empty for another value.
std::vector<std::string_view> step_items(std::string_view list);

// The number of a reference "#12"; 0 for another value.
std::uint64_t step_reference(std::string_view value);

// Calls `found` with the number of each reference outside strings.
void each_step_reference(std::string_view arguments,
                         const std::function<void(std::uint64_t)>& found);

// UTF-8 text of a string with its quotes: 'T\X2\00FC\X0\r'. Empty for another value. Control
// characters become '?'; bytes above 0x7f are kept, as some programs write UTF-8.
std::string step_string(std::string_view value);

}  // namespace rayloc
