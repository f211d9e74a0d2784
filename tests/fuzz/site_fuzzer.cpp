// site.toml: any text gives a site or errors with a place; never more than that.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "daemon/site/model/site.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // The folder of the file does not exist: nothing that the text names is found.
  const rayloc::Expected<rayloc::Site> site =
      rayloc::parse_site({reinterpret_cast<const char*>(data), size}, "/nonexistent/site.toml");
  if (site || site.error().message.rfind("/nonexistent/site.toml:", 0) != 0) {
    std::abort();  // a site without its scene, or an error without its place
  }
  return 0;
}
