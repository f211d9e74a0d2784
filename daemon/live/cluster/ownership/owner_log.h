// OwnerLog: writes the records of the owner of a site to the stream of results: each after
// its predecessor, or not at all. The broker refuses a record whose writer does not name the
// last one, so an owner that was replaced while it was suspended can publish nothing more.
//
// Thread safety: one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/site_start.h"
#include "engine/base/expected.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

class OwnerLog {
 public:
  struct Options {
    std::string site;
    std::uint64_t generation = 0;  // of the claim
    std::string worker;
    std::string build;  // version of the software
    StreamOptions stream;
    // For a former standby: its own start, with the generation of the owner that it followed.
    std::optional<SiteStart> along = std::nullopt;
  };

  // Reads the last record of the site and writes Begin after it. An
  // Error where a later generation has published, or another owner than
  // the one that it followed, or where the broker does not answer.
  static Expected<std::unique_ptr<OwnerLog>> begin(std::shared_ptr<Broker> broker, Options options);

  // Start, as in Begin.
  const SiteStart& start() const { return start_; }

  enum class Outcome : std::uint8_t { kStored, kNotYet, kReplaced };
  // kNotYet: the same record is to be written again. kReplaced: another worker owns the site.
  Outcome append(const v1::SiteOutput& output);
  // Maximum size of the items of a record, so that the broker takes it [bytes].
  std::size_t most_items() const { return broker_->max_message() / 2; }

 private:
  OwnerLog(std::shared_ptr<Broker> broker, Options options)
      : broker_(std::move(broker)),
        options_(std::move(options)),
        subject_(output_subject_of(options_)) {}
  static std::string output_subject_of(const Options& options);
  Outcome confirm(const std::string& bytes);
  Expected<std::uint64_t> claimed_generation();

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  const std::string subject_;
  SiteStart start_;
  std::uint64_t last_ = 0;   // sequence of the last record of the site
  std::uint64_t begun_ = 0;  // sequence of our Begin
  std::uint64_t number_ = 0;
};

// Arithmetic of this program, "fma" or "no_fma": they differ in the last digits.
std::string arithmetic();

}  // namespace rayloc
