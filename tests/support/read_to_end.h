// read_to_end(): all that a source gives, to the test that wants it.
#pragma once

#include <gtest/gtest.h>

#include "capture/transport/datagram_source.h"

namespace rayloc::test {

// Calls take(datagram) with each; what it refers to is valid only there. An error fails the test
// and is the end as well, or a damaged file would keep a test for ever.
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
