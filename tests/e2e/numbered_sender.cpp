#include "tests/e2e/numbered_sender.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "capture/source/pcap_source.h"

namespace rayloc::e2e {
namespace {

constexpr std::size_t kPayloadBytes = 200;

}  // namespace

NumberedSender::NumberedSender(std::uint16_t port) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::system_error(errno, std::generic_category(), "no socket to send from");
  }
}

NumberedSender::~NumberedSender() {
  end();
  close(socket_);
}

void NumberedSender::send(int count) {
  std::array<char, kPayloadBytes> payload{};
  for (int i = 0; i < count; ++i) {
    const std::uint64_t number = sent_;
    std::memcpy(payload.data(), &number, sizeof number);
    times_.push_back(std::chrono::steady_clock::now());
    // Refused once no receiver is bound: it counts as sent all the same.
    ::send(socket_, payload.data(), payload.size(), MSG_NOSIGNAL);
    ++sent_;
  }
}

void NumberedSender::begin(int per_millisecond) {
  thread_ = std::thread([this, per_millisecond] {
    auto next = std::chrono::steady_clock::now();
    while (!ending_) {
      send(per_millisecond);
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
    }
  });
}

void NumberedSender::end() {
  ending_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

bool NumberedRecording::is_prefix() const {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] != i) {
      return false;
    }
  }
  return true;
}

NumberedRecording read_numbered(const std::filesystem::path& folder, const std::string& suffix) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().string();
    if (name.size() > suffix.size() &&
        name.compare(name.size() - suffix.size(), suffix.size(), suffix) == 0) {
      files.push_back(entry.path());
    }
  }
  // "…Z-10.pcap" is younger than "…Z-9.pcap", and both than "…Z.pcap".
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    const std::string x = a.stem().string();
    const std::string y = b.stem().string();
    return std::pair(x.substr(0, x.find('Z')), std::pair(x.size(), x)) <
           std::pair(y.substr(0, y.find('Z')), std::pair(y.size(), y));
  });
  NumberedRecording all;
  all.files = files.size();
  for (const std::filesystem::path& file : files) {
    const auto source =
        PcapFileSource::open(file.string(), {.port = {}, .max_disorder = kAnyDisorder});
    DatagramBatch batch;
    while (source && !batch.ended) {
      const Expected<void> read = (*source)->read(batch, Duration::zero());
      if (!read) {
        all.trouble += read.error().message + "\n";
        break;
      }
      for (const Datagram& datagram : batch.datagrams) {
        std::uint64_t number = ~std::uint64_t{0};
        if (datagram.payload.size() == kPayloadBytes) {
          std::memcpy(&number, datagram.payload.data(), sizeof number);
        }
        all.numbers.push_back(number);
      }
    }
    if (!source) {
      all.trouble += source.error().message + "\n";
      continue;
    }
    SourceCounters counters = (*source)->counters();
    all.gap_marks += counters.rejected["gap_mark"];
    all.unrecorded += counters.unrecorded;
    for (const std::string& line : (*source)->warnings()) {
      all.trouble += line;
    }
  }
  return all;
}

}  // namespace rayloc::e2e
