#include "daemon/live/cluster/ownership/owner_log.h"

#include <fmt/format.h>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/pipeline/output/carried_message.h"

namespace rayloc {
namespace {

// Chosen: records that the previous owner may add while this one reads its last one.
constexpr int kTries = 20;

// Without the flag nothing here uses FMA, even if the processor supports it.
#ifdef __FMA__
constexpr const char* kArithmetic = "fma";
#else
constexpr const char* kArithmetic = "no_fma";
#endif

Error replaced(const std::string& site, std::uint64_t by) {
  return {ErrorKind::kUnavailable,
          fmt::format("site '{}': an owner of generation {} has spoken already", site, by)};
}

Error followed_another(const std::string& site) {
  return {ErrorKind::kUnavailable,
          "site '" + site + "': its last owner is not the owner that this standby followed"};
}

v1::Begin begin_message(const OwnerLog::Options& options, const SiteStart& start) {
  v1::Begin begin;
  begin.set_worker(options.worker);
  begin.set_build(options.build);
  begin.set_arithmetic(arithmetic());
  *begin.mutable_resume() = position_message(start.resume);
  begin.set_done_us(us_of(start.from));
  if (start.carried) {
    begin.set_carried(carried_message(*start.carried).SerializeAsString());
  }
  if (options.along) {
    v1::StoodBy& stood_by = *begin.mutable_stood_by();
    *stood_by.mutable_resume() = position_message(options.along->resume);
    stood_by.set_from_us(us_of(options.along->from));
    if (options.along->carried) {
      stood_by.set_carried(carried_message(*options.along->carried).SerializeAsString());
    }
  }
  return begin;
}

}  // namespace

std::string arithmetic() { return kArithmetic; }

std::string OwnerLog::output_subject_of(const Options& options) {
  return output_subject(options.site);
}

Expected<std::unique_ptr<OwnerLog>> OwnerLog::begin(std::shared_ptr<Broker> broker,
                                                    Options options) {
  // A standby has received records of the stream. If it is gone, its owner is not the one followed.
  RAYLOC_TRY(options.along ? Expected<void>() : broker->ensure_stream(options.stream));
  std::unique_ptr<OwnerLog> log(new OwnerLog(std::move(broker), std::move(options)));
  for (int i = 0; i < kTries; ++i) {
    const auto last = log->broker_->last_of(std::string(kOutputStream), log->subject_);
    RAYLOC_TRY(last);
    v1::OutputRecord record;
    if (*last && !unseal((*last)->data, record)) {
      record.Clear();  // an invalid record: the site starts anew
    }
    if (record.generation() >= log->options_.generation) {
      return tl::make_unexpected(replaced(log->options_.site, record.generation()));
    }
    if (log->options_.along && record.generation() != log->options_.along->generation) {
      return tl::make_unexpected(followed_another(log->options_.site));
    }
    auto start = start_after(record);
    log->start_ = start ? *std::move(start) : SiteStart{};
    log->start_.generation = log->options_.generation;
    v1::OutputRecord begin;
    begin.set_generation(log->options_.generation);
    begin.set_number(1);
    *begin.mutable_begin() = begin_message(log->options_, log->start_);
    const std::string bytes = seal(begin);
    log->last_ = *last ? (*last)->sequence : 0;
    const auto sent = log->broker_->publish_behind(log->subject_, bytes, log->last_);
    if (sent && sent->is_last) {
      log->begun_ = log->last_ = sent->sequence;
      log->number_ = 1;
      return log;
    }
    if (log->confirm(bytes) == Outcome::kStored) {
      log->begun_ = log->last_;
      return log;
    }
  }
  return make_error(ErrorKind::kUnavailable,
                    "site '" + log->options_.site + "': its results cannot be written");
}

OwnerLog::Outcome OwnerLog::append(const v1::SiteOutput& output) {
  v1::OutputRecord record;
  record.set_generation(options_.generation);
  record.set_number(number_ + 1);
  *record.mutable_output() = output;
  record.set_begin_sequence(begun_);
  const std::string bytes = seal(record);
  const auto sent = broker_->publish_behind(subject_, bytes, last_);
  if (sent && sent->is_last) {
    last_ = sent->sequence;
    ++number_;
    return Outcome::kStored;
  }
  return confirm(bytes);
}

// The reply was lost, or another writer has published: the last record of the site decides.
OwnerLog::Outcome OwnerLog::confirm(const std::string& bytes) {
  const auto last = broker_->last_of(std::string(kOutputStream), subject_);
  if (!last) {
    return Outcome::kNotYet;
  }
  if (!*last) {  // records have expired, or the server has lost them
    const auto claimed = claimed_generation();
    if (!claimed || *claimed > options_.generation) {
      return claimed ? Outcome::kReplaced : Outcome::kNotYet;
    }
    (void)broker_->ensure_stream(options_.stream);
    last_ = 0;
    return Outcome::kNotYet;
  }
  if ((*last)->data == bytes) {
    last_ = (*last)->sequence;
    ++number_;
    return Outcome::kStored;
  }
  v1::OutputRecord record;
  const bool is_record = unseal((*last)->data, record).has_value();
  const bool is_ours =
      is_record && record.generation() == options_.generation && record.number() == number_;
  if (is_record && record.generation() >= options_.generation && !is_ours) {
    return Outcome::kReplaced;
  }
  last_ = (*last)->sequence;  // ours, or an invalid record, which readers skip
  return Outcome::kNotYet;
}

// Claims never expire: an owner suspended beyond the retention of results finds its successor here.
Expected<std::uint64_t> OwnerLog::claimed_generation() {
  const auto last = broker_->last_of(std::string(kClaimStream), claim_subject(options_.site));
  RAYLOC_TRY(last);
  v1::SiteClaim claim;
  return *last && unseal((*last)->data, claim) ? claim.generation() : 0;
}

}  // namespace rayloc
