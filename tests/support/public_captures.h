// Recordings that other people made with real access points. They belong to their authors and are
// not part of this checkout: tests/data/captures/README.md states the origin of each.
//
// They are read from $RAYLOC_PUBLIC_CAPTURES, or, if it is not set, from shared/captures beside the
// checkout. A test that reads them is a test of the fixture PublicCaptures, which is skipped, by
// name, where that folder is absent.
#pragma once

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/recording.h"

namespace rayloc::test {

// The folder, if it exists.
std::optional<std::string> public_captures();

// Path of `name` ("axcsi-rt-ax86u/AllData.pcap") in that folder. Throws std::runtime_error if
// the file is absent, or its SHA-256 is not the one that tests/data/captures/README.md states.
std::string public_capture(const std::string& name);

// The datagrams of that file, a pcap.
Recording read_public_capture(const std::string& name);

class PublicCaptures : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!public_captures()) {
      GTEST_SKIP() << "no recordings of other people here: see tests/data/captures/README.md";
    }
  }
};

}  // namespace rayloc::test
