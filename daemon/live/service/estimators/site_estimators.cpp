#include "daemon/live/service/estimators/site_estimators.h"

#include <set>
#include <utility>

#include "daemon/live/config/engine_options.h"

namespace rayloc {
namespace {

std::set<MacAddress> listed_addresses(const Site& site) {
  std::set<MacAddress> all;
  for (const SiteTransmitter& transmitter : site.transmitters) {
    all.insert(transmitter.mac);
  }
  return all;
}

std::set<MacAddress> fixed_addresses(const Site& site) {
  std::set<MacAddress> all;
  for (const SiteTransmitter& transmitter : site.transmitters) {
    if (transmitter.role == TransmitterRole::kFixed) {
      all.insert(transmitter.mac);
    }
  }
  return all;
}

ComparedMethod::Options compared_options(const Method& method, const SiteSetup& setup) {
  ComparedMethod::Options options;
  options.name = method.name;
  options.max_frames = setup.config.limits.ring_frames;
  options.wants = [fixed = fixed_addresses(setup.site),
                   devices = method.create_device != nullptr,
                   people = method.create_person != nullptr](const MacAddress& transmitter) {
    return fixed.count(transmitter) != 0 ? people : devices;
  };
  options.rank = [listed = listed_addresses(setup.site)](const MacAddress& transmitter) {
    return listed.count(transmitter) != 0 ? Rank::kListed : Rank::kOther;
  };
  return options;
}

}  // namespace

SiteEstimators::SiteEstimators(const SiteSetup& setup, Options options)
    : setup_(setup), options_(std::move(options)) {}

Expected<std::unique_ptr<SiteEstimators>> SiteEstimators::create(const SiteSetup& setup,
                                                                 Options options) {
  std::unique_ptr<SiteEstimators> made(new SiteEstimators(setup, std::move(options)));
  const EngineConfig& engine = setup.config.engine;
  if (const Method* method = engine.method; method != nullptr) {
    auto both = made->make_both(*method);
    RAYLOC_TRY(both);
    made->devices_ = std::move(both->devices);
    made->people_ = std::move(both->people);
  }
  for (std::size_t i = 0; i < engine.compared.size(); ++i) {
    const Method& method = *engine.compared[i];
    auto compared = made->make_compared(method);
    if (!compared) {
      // A reload may have changed the file since.
      const bool has_place = i + 1 < setup.method_places.size();
      return make_error(
          compared.error().kind,
          (has_place ? setup.method_places[i + 1] : setup.config.file.string() + ": ") +
              "method '" + std::string(method.name) + "': " + compared.error().message);
    }
    made->compared_.push_back(std::move(*compared));
  }
  made->assemble(nullptr);
  return made;
}

MethodOptions SiteEstimators::settings_of(const Method& method) const {
  MethodOptions settings = engine_options(method, setup_.config.engine);
  settings.path_grids = options_.path_grids;
  return settings;
}

// Chains are stored for the site's method alone.
Expected<std::unique_ptr<DeviceEstimator>> SiteEstimators::make_devices(
    const Method& method) const {
  DeviceEstimator::Options devices;
  devices.method = &method;
  devices.settings = settings_of(method);
  devices.names = options_.names;
  devices.snapshots =
      setup_.config.engine.snapshots_always ? Snapshots::kAlways : Snapshots::kAcquire;
  if (&method == setup_.config.engine.method) {
    devices.chains = {options_.chain_file, options_.chain_file};
  }
  return DeviceEstimator::create(setup_.site, devices);
}

Expected<std::unique_ptr<PersonEstimator>> SiteEstimators::make_people(
    const Method& method, const std::shared_ptr<const Carried>& before) const {
  PersonEstimator::Options people;
  people.method = &method;
  people.settings = settings_of(method);
  people.before = before;
  if (method.create_device == nullptr) {  // otherwise the devices provide the chains
    people.chain_file = options_.chain_file;
  }
  return PersonEstimator::create(setup_.site, people);
}

Expected<SiteEstimators::Both> SiteEstimators::make_both(const Method& method) const {
  Both both;
  if (method.create_device != nullptr) {
    auto devices = make_devices(method);
    RAYLOC_TRY(devices);
    both.devices = std::move(*devices);
  }
  if (method.create_person != nullptr && setup_.site.reference_file) {
    auto people = make_people(method, nullptr);
    RAYLOC_TRY(people);
    both.people = std::move(*people);
  }
  return both;
}

Expected<std::unique_ptr<ComparedMethod>> SiteEstimators::make_compared(
    const Method& method) const {
  auto both = make_both(method);
  RAYLOC_TRY(both);
  std::vector<std::unique_ptr<Estimator>> estimators;
  if (both->devices) {
    estimators.push_back(std::move(both->devices));
  }
  if (both->people) {
    estimators.push_back(std::move(both->people));
  }
  return std::make_unique<ComparedMethod>(compared_options(method, setup_), std::move(estimators));
}

void SiteEstimators::assemble(const Carried* before) {
  list_ = {};
  if (devices_) {
    list_.add(*devices_);
  }
  if (people_) {
    list_.add(*people_);
  }
  zones_ = std::make_unique<ZoneEstimator>(list_, setup_.site.zones, before);
  if (!compared_.empty()) {
    with_others_ = std::make_unique<ComparedEstimator>(*zones_, compared());
  }
}

Expected<void> SiteEstimators::go_on(const std::shared_ptr<const Carried>& before) {
  if (devices_) {
    devices_->go_on(*before);
  }
  if (people_) {
    auto people = make_people(*setup_.config.engine.method, before);
    RAYLOC_TRY(people);
    people_ = std::move(*people);
  }
  assemble(before.get());
  return {};
}

Estimator& SiteEstimators::estimator() {
  return with_others_ ? static_cast<Estimator&>(*with_others_) : *zones_;
}

void SiteEstimators::stop_compared() {
  for (const auto& compared : compared_) {
    compared->stop();
  }
}

const RoomModel* SiteEstimators::room() const {
  return devices_ ? &devices_->room() : people_ ? &people_->room() : nullptr;
}

}  // namespace rayloc
