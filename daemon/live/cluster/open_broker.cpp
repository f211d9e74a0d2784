#include <dlfcn.h>

#include <filesystem>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/nats/module.h"
#include "daemon/live/cluster/operate/nkey.h"

namespace rayloc {
namespace {

// The module stays loaded: libnats has threads. Returns null with the reason in `why`.
nats::Open find_module(std::string& why) {
#ifdef RAYLOC_NATS_LINKED
  (void)why;
  return rayloc_open_nats;
#else
  std::error_code failed;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failed);
  const std::filesystem::path file = (program.parent_path() / nats::kModule).lexically_normal();
  void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (module == nullptr) {
    const char* const message = ::dlerror();
    why = message != nullptr ? message : file.string();
    return nullptr;
  }
  return reinterpret_cast<nats::Open>(::dlsym(module, nats::kOpen));
#endif
}

}  // namespace

Expected<std::shared_ptr<Broker>> open_broker(const BrokerOptions& options) {
  std::string nkey;
  if (!options.nkey_seed_file.empty()) {
    Expected<std::string> made = read_nkey(options.nkey_seed_file);
    RAYLOC_TRY(made);
    nkey = std::move(*made);
  }
  std::string why;
  const nats::Open open = find_module(why);
  if (open == nullptr) {
    return make_error(ErrorKind::kUnavailable,
                      "[cluster]: the connection to NATS cannot be loaded (" + why +
                          "); install the package raylocd-cluster, or libnats-dev and build with "
                          "-DRAYLOC_CLUSTER=ON, or leave [cluster] out");
  }
  Expected<std::shared_ptr<Broker>> opened = std::shared_ptr<Broker>();
  open(options, nkey, opened);
  return opened;
}

}  // namespace rayloc
