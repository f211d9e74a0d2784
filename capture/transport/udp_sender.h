// DatagramSender: sends UDP datagrams to several destinations, many by one system call.
#pragma once

#include <netinet/in.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc::cli {

class DatagramSender {
 public:
  static constexpr std::size_t kBatch = 64;

  static Expected<DatagramSender> create(std::vector<sockaddr_in> destinations);
  ~DatagramSender();
  DatagramSender(DatagramSender&& other) noexcept;
  DatagramSender& operator=(DatagramSender&&) = delete;

  // Copies the payload; what is queued leaves with flush() or when a batch is full. Whether anybody
  // listens at the destination is not known, as it is not to the access point.
  Expected<void> queue(std::size_t destination, std::span<const std::byte> payload);
  Expected<void> flush();

  std::uint64_t sent() const { return sent_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  DatagramSender(int fd, std::vector<sockaddr_in> destinations);

  struct Queued {
    std::size_t destination;
    std::size_t size;
  };

  int fd_;
  std::vector<sockaddr_in> destinations_;
  std::vector<Queued> queued_;
  std::vector<std::byte> payloads_;
  std::uint64_t sent_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace rayloc::cli
