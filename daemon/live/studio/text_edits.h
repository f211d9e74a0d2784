// TextEdits: replacements of parts of a text; all positions refer to the original text.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace rayloc {

class TextEdits {
 public:
  // Replaces the part from `begin` up to `end`; an
  // insertion if both are equal. Parts do not overlap.
  void replace(std::size_t begin, std::size_t end, std::string text) {
    edits_.push_back({begin, end, std::move(text)});
  }
  bool empty() const { return edits_.empty(); }

  // Insertions at one position are applied in the order of the calls.
  std::string apply(const std::string& text) const {
    std::vector<Edit> sorted = edits_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const Edit& a, const Edit& b) {
      return a.begin < b.begin;
    });
    std::string edited;
    std::size_t at = 0;
    for (const Edit& edit : sorted) {
      if (edit.begin > at) {
        edited += text.substr(at, edit.begin - at);
      }
      edited += edit.text;
      at = std::max(at, edit.end);
    }
    return edited + text.substr(std::min(at, text.size()));
  }

 private:
  struct Edit {
    std::size_t begin;
    std::size_t end;
    std::string text;
  };
  std::vector<Edit> edits_;
};

}  // namespace rayloc
