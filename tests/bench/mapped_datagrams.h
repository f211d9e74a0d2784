// Datagrams in a memory-mapped file: a recording written again and again with the sequence numbers
// and times going on, so that no datagram is a duplicate and the whole is larger than any cache.
#pragma once

#include <cstddef>
#include <vector>

#include "capture/transport/datagram.h"
#include "tests/support/recording.h"

namespace rayloc::bench {

class MappedDatagrams {
 public:
  // `recording`: AX-CSI datagrams, at least one. Throws std::runtime_error when a file cannot be
  // written or mapped.
  MappedDatagrams(test::Recording recording, std::size_t at_least);
  ~MappedDatagrams();
  MappedDatagrams(const MappedDatagrams&) = delete;
  MappedDatagrams& operator=(const MappedDatagrams&) = delete;

  const std::vector<Datagram>& datagrams() const { return datagrams_; }
  std::size_t bytes() const { return size_; }

 private:
  void* map_ = nullptr;
  std::size_t size_ = 0;
  std::vector<Datagram> datagrams_;
};

}  // namespace rayloc::bench
