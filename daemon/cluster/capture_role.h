// CaptureRole: what a capture node has besides its sources: a BatchSender for each site, told what
// the workers have consumed and what they lack.
//
// Thread safety: add_site() and remove_site() from one thread, the rest from any.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/cluster/batch_sender.h"
#include "daemon/cluster/broker.h"

namespace rayloc {

class CaptureRole {
 public:
  struct Options {
    std::string node;
    std::uint64_t epoch = 0;  // of this start; no other has the same
    // Of each site; `site`, `node`, `epoch` and the stream's names are filled in.
    BatchSender::Options sender;
  };

  static Expected<std::unique_ptr<CaptureRole>> open(std::shared_ptr<Broker> broker,
                                                     Options options);

  // Not started. It takes the place of one of that name, under another epoch: to its readers the
  // node was started anew.
  Expected<std::shared_ptr<BatchSender>> add_site(const std::string& site);
  // It is heard no more: its sender, which has finished, is let go.
  void remove_site(const std::string& site);

 private:
  CaptureRole(std::shared_ptr<Broker> broker, Options options)
      : broker_(std::move(broker)), options_(std::move(options)) {}
  void take_request(const BrokerMessage& message);
  void take_output(const std::string& site, const BrokerMessage& message);
  std::shared_ptr<BatchSender> sender_of(const std::string& site) const;

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  mutable std::mutex mutex_;
  std::uint64_t starts_ = 0;                                     // guarded by mutex_
  std::map<std::string, std::shared_ptr<BatchSender>> senders_;  // guarded by mutex_; by site
  std::map<std::string, std::unique_ptr<Broker::Subscription>> outputs_;  // guarded by mutex_
  std::unique_ptr<Broker::Subscription> requests_;  // last: ends before what it looks at
};

// The stream of a site as it is made where nobody has made it. `options`: how long and where it
// keeps.
StreamOptions site_stream(const std::string& site, StreamOptions options);
// The stream of history, of all sites. `options`: on how many servers it is kept.
StreamOptions fill_stream(StreamOptions options);
// The stream of what the owners of all sites say.
StreamOptions output_stream(StreamOptions options);

}  // namespace rayloc
