// CaptureRole: the cluster part of a capture node: a BatchSender for each site,
// informed about the batches that the workers have consumed and those that they lack.
//
// Thread safety: add_site() and remove_site() from one thread, the rest from any.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/live/cluster/batch_sender.h"
#include "daemon/live/cluster/broker.h"

namespace rayloc {

class CaptureRole {
 public:
  struct Options {
    std::string node;
    std::uint64_t epoch = 0;  // of this start; unique
    // For each site; `site`, `node`, `epoch` and the stream's names are filled in.
    BatchSender::Options sender;
  };

  static Expected<std::unique_ptr<CaptureRole>> open(std::shared_ptr<Broker> broker,
                                                     Options options);

  // Returns a sender that is not started. It replaces a sender of the same
  // name, under another epoch: to its readers the node was restarted.
  Expected<std::shared_ptr<BatchSender>> add_site(const std::string& site);
  // Ends the reception for a site: its sender, which has finished, is released.
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
  std::unique_ptr<Broker::Subscription> requests_;  // last: ends before the members it uses
};

// Configuration of the stream of a site, for its
// creation. `options`: retention and storage.
StreamOptions site_stream(const std::string& site, StreamOptions options);
// Configuration of the history stream of all sites. `options`: number of replicas.
StreamOptions fill_stream(StreamOptions options);
// Configuration of the stream of the results of all sites.
StreamOptions output_stream(StreamOptions options);

}  // namespace rayloc
