// One line of text for a published message, for people (`rayloc sub` without --json).
#pragma once

#include <string>

namespace rayloc::v1 {
class Envelope;
}  // namespace rayloc::v1

namespace rayloc::cli {

// The time of day in UTC, the kind of message, and a summary of its content. No newline.
std::string message_line(const v1::Envelope& envelope);

}  // namespace rayloc::cli
