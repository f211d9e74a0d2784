// read_to_end(): passes all datagrams of a source to a test.
#pragma once

#include <gtest/gtest.h>

#include "capture/transport/datagram_source.h"

namespace rayloc::test {

// Calls take(datagram) with each; references in it are valid only during the call. An error fails
// the test and ends the reading, because a damaged file would otherwise block a test forever.
template <typename Take>
void read_to_end(DatagramSource& source, Take take) {
  DatagramBatch batch;
  while (!batch.ended) {
    if (const auto read = source.read(batch, Duration::zero()); !read) {
      ADD_FAILURE() << read.error().message;
      return;
    }
    for (const Datagram& datagram : batch.datagrams) {
      take(datagram);
    }
  }
}

inline void read_to_end(DatagramSource& source) {
  read_to_end(source, [](const Datagram&) {});
}

}  // namespace rayloc::test
