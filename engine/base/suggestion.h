// closest_name: what a writer may have meant, for messages ("did you mean 'concrete'?").
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rayloc {

// The candidate with the smallest edit distance (insert, delete, replace), the first one of equals;
// nothing when even that one differs in more than a third of its letters.
std::optional<std::string> closest_name(std::string_view name,
                                        std::span<const std::string> candidates);

// " (did you mean 'X'?)", or " (there are: A, B, C)" when nothing is near; empty without
// candidates.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

}  // namespace rayloc
