#include "daemon/cli/terminal/terminal_notes.h"

#include <string>

#include <gtest/gtest.h>

namespace rayloc::cli::terminal_notes_test {
namespace {

std::string printed(const Observer& observer) {
  ::testing::internal::CaptureStderr();
  observer.progress(0.5, "stage");
  observer.note("100 % sure");
  observer.note("second");
  return ::testing::internal::GetCapturedStderr();
}

TEST(TerminalNotes, ArePrintedEachOnALine) {
  EXPECT_EQ(printed(terminal_notes(false)), "100 % sure\nsecond\n");
}

TEST(TerminalNotes, AreNotPrintedWhenQuiet) { EXPECT_EQ(printed(terminal_notes(true)), ""); }

}  // namespace
}  // namespace rayloc::cli::terminal_notes_test
