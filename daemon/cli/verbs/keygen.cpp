// `rayloc keygen FILE`: makes a key pair for CURVE or NATS: the secret key goes to FILE, readable
// by its owner only, the public key to standard output.
#include <cstdio>
#include <memory>
#include <string>

#include "daemon/base/secret_file.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/live/cluster/operate/nkey.h"
#include "daemon/live/publish/socket/curve_keys.h"

namespace rayloc::cli {
namespace {

struct KeygenArguments {
  std::string file;
  bool of_existing = false;
  bool of_nats = false;
};

Expected<std::string> public_key_of(const KeygenArguments& arguments) {
  if (arguments.of_nats) {
    return read_nkey(arguments.file);
  }
  const Expected<CurveKeyPair> keys = read_curve_secret(arguments.file);
  return keys ? Expected<std::string>(keys->public_key) : tl::make_unexpected(keys.error());
}

Expected<void> run_keygen(const KeygenArguments& arguments) {
  if (!arguments.of_existing) {
    const std::string secret = arguments.of_nats ? make_nkey_seed() : make_curve_keys().secret_key;
    if (const Expected<void> written = write_secret(arguments.file, secret); !written) {
      return report_file_error(written.error());
    }
  }
  const Expected<std::string> key = public_key_of(arguments);
  if (!key) {
    return report_file_error(key.error());
  }
  std::printf("%s\n", key->c_str());
  return {};
}

RunVerb declare_keygen(OptionParser& app) {
  const auto arguments = std::make_shared<KeygenArguments>();
  app.add_option(
         "FILE", arguments->file, "File for the secret key; a file that exists is never changed")
      ->required();
  app.add_flag(
      "--public", arguments->of_existing, "Make nothing: print the public key of the one in FILE");
  app.add_flag(
      "--nkey",
      arguments->of_nats,
      "Make the identity of a machine of a cluster at its NATS servers ([cluster] nkey_seed_file)");
  return [arguments] { return run_keygen(*arguments); };
}

}  // namespace

extern const Verb kKeygen;
const Verb kKeygen = {
    "keygen",
    "Make the keys of encrypted publishing, or of a cluster: secret into a file, public printed",
    "rayloc keygen /etc/raylocd/curve.secret",
    declare_keygen};

}  // namespace rayloc::cli
