#include "daemon/live/output/publisher_stage.h"

#include <algorithm>
#include <utility>

#include "daemon/messages/csi_message.h"
#include "daemon/messages/location_message.h"

namespace rayloc {

PublisherStage::PublisherStage(Publisher publisher, Options options)
    : publisher_(std::move(publisher)),
      options_(std::move(options)),
      heartbeat_(options_.heartbeat.count()) {}

PublisherStage::~PublisherStage() { halt(); }

std::shared_ptr<SiteOutput> PublisherStage::make_output(SiteOutput::Options options) {
  auto output = std::make_shared<SiteOutput>(std::move(options));
  output->on_something([this] {
    {
      const std::lock_guard lock(mutex_);
      pending_ = true;
    }
    wake_.notify_one();
  });
  return output;
}

void PublisherStage::add(const std::shared_ptr<SiteOutput>& output) {
  const std::lock_guard lock(mutex_);
  outputs_.push_back(output);
}

void PublisherStage::remove(const std::shared_ptr<SiteOutput>& output,
                            const std::optional<std::string>& goodbye) {
  Leaving leaving{output, output->report(options_.now()), goodbye};
  output->close();
  {
    const std::lock_guard lock(mutex_);
    std::erase(outputs_, output);
    leaving_.push_back(std::move(leaving));
    pending_ = true;
  }
  wake_.notify_one();
}

void PublisherStage::halt() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void PublisherStage::start() {
  thread_ = std::thread([this] { run(); });
}

void PublisherStage::run() {
  auto next_status = std::chrono::steady_clock::now();
  bool finishing = false;
  while (!finishing) {
    progress_.beat();
    std::vector<std::shared_ptr<SiteOutput>> outputs;
    std::vector<Leaving> leaving;
    {
      std::unique_lock lock(mutex_);
      progress_.rest();
      wake_.wait_until(lock, next_status, [&] { return finishing_ || pending_; });
      progress_.beat();
      pending_ = false;
      finishing = finishing_;
      outputs = outputs_;
      std::swap(leaving, leaving_);
    }
    for (Leaving& one : leaving) {
      let_go(std::move(one));
    }
    for (const auto& output : outputs) {
      publish_waiting(*output);
    }
    note_published(outputs);
    if (finishing || std::chrono::steady_clock::now() >= next_status) {
      for (const auto& output : outputs) {
        const Timestamp now = options_.now();
        if (std::optional<StatusMessages> status = output->report(now)) {
          publish_status(*output, std::move(*status), now);
        }
        progress_.beat();
      }
      next_status = std::chrono::steady_clock::now() + Duration(heartbeat_);
    }
  }
  progress_.rest();
}

void PublisherStage::publish_waiting(SiteOutput& output) {
  const SiteOutput::Waiting waiting = output.take();
  const SiteOutput::Options& site = output.options();
  publisher_.turn_to(site.site, site.board);
  const Duration ahead = site.clock_ahead ? site.clock_ahead() : Duration::zero();
  for (const SiteOutput::WaitingLocation& one : waiting.locations) {
    publisher_.publish(location_message(one.location, ahead), options_.now(), one.coalesced);
  }
  for (const SiteOutput::Event& event : waiting.events) {
    std::visit(
        [&](const auto& one) { publisher_.publish(event_message(one, ahead), options_.now()); },
        event);
  }
  for (const SiteOutput::Message& message : waiting.messages) {
    std::visit([&](const auto& one) { publisher_.publish(one, options_.now()); }, message);
  }
  for (const SiteOutput::WaitingCsi& one : waiting.csi) {
    publisher_.publish(csi_message(one.frame, one.access_point, site.name(one.frame)),
                       options_.now());
  }
  for (const SiteOutput::WaitingLocation& one : waiting.compared) {
    publisher_.publish_compared(
        compared_message(one.location, ahead), options_.now(), one.coalesced);
  }
}

void PublisherStage::publish_status(const SiteOutput& output,
                                    StatusMessages status,
                                    Timestamp now) {
  publisher_.turn_to(output.options().site, output.options().board);
  for (const v1::SourceState& source : status.sources) {
    publisher_.publish(source, now);
  }
  publisher_.publish(std::move(status.heartbeat), now);
}

void PublisherStage::publish_goodbye(const SiteOutput& output, const std::string& reason) {
  publisher_.turn_to(output.options().site, output.options().board);
  v1::Goodbye goodbye;
  goodbye.set_reason(reason);
  publisher_.publish(std::move(goodbye), options_.now());
}

void PublisherStage::let_go(Leaving leaving) {
  publish_waiting(*leaving.output);
  if (leaving.status) {
    publish_status(*leaving.output, std::move(*leaving.status), options_.now());
  }
  if (leaving.goodbye) {
    publish_goodbye(*leaving.output, *leaving.goodbye);
  }
}

void PublisherStage::note_published(const std::vector<std::shared_ptr<SiteOutput>>& outputs) {
  const PublishedCounters published = publisher_.counters();
  for (const auto& output : outputs) {
    output->note_published(published);
  }
  const std::lock_guard lock(mutex_);
  published_ = published;
}

void PublisherStage::finish(const std::string& reason) {
  halt();
  for (const auto& output : outputs_) {
    publish_goodbye(*output, reason);
  }
}

PublishedCounters PublisherStage::published() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

}  // namespace rayloc
