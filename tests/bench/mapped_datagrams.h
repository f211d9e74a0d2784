// Datagrams in a memory-mapped file: a real recording written again and again with the sequence
// numbers and times going on, so that no datagram is a duplicate and the whole is larger than any
// cache.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "capture/datagram.h"

namespace rayloc::bench {

class MappedDatagrams {
 public:
  // `capture` is a plain pcap file of AX-CSI datagrams below tests/data/captures. Throws
  // std::runtime_error when a file cannot be read, written or mapped.
  MappedDatagrams(const std::string& capture, std::size_t at_least);
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
