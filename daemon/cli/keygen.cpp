// `rayloc keygen FILE`: makes a pair of CURVE keys: the secret one into FILE, which only its owner
// may read, the public one on standard output.
#include <cstdio>
#include <memory>
#include <string>

#include "daemon/cli/verbs.h"
#include "daemon/command/file_error.h"
#include "daemon/command/verb.h"
#include "daemon/publish/socket/curve_keys.h"

namespace rayloc::cli {
namespace {

Expected<void> print_public(const CurveKeyPair& keys) {
  std::printf("%s\n", keys.public_key.c_str());
  return {};
}

Expected<void> run(const std::string& file, bool of_existing) {
  if (of_existing) {
    const Expected<CurveKeyPair> keys = read_curve_secret(file);
    return keys ? print_public(*keys) : report_file_error(keys.error());
  }
  const CurveKeyPair keys = make_curve_keys();
  if (const Expected<void> written = write_curve_secret(file, keys.secret_key); !written) {
    return report_file_error(written.error());
  }
  return print_public(keys);
}

RunVerb declare(OptionParser& app) {
  const auto file = std::make_shared<std::string>();
  const auto of_existing = std::make_shared<bool>(false);
  app.add_option("FILE", *file, "Where the secret key goes; a file that exists is never changed")
      ->required();
  app.add_flag("--public", *of_existing, "Make nothing: print the public key of the one in FILE");
  return [file, of_existing] { return run(*file, *of_existing); };
}

}  // namespace

extern const Verb kKeygen;
const Verb kKeygen = {"keygen",
                      "Make the keys of encrypted publishing: secret into a file, public printed",
                      "rayloc keygen /etc/raylocd/curve.secret",
                      declare};

}  // namespace rayloc::cli
