#include "tests/support/golden.h"

#include <array>
#include <memory>
#include <stdexcept>

#include <zlib.h>

#include "tests/support/test_paths.h"

namespace rayloc::test {

nlohmann::json golden(const std::string& name) {
  const std::string path = data_path("/goldens/") + name + ".json.gz";
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (file == nullptr) {
    throw std::runtime_error("cannot read " + path);
  }
  std::string text;
  std::array<char, 65'536> buffer{};
  for (int n = 0; (n = gzread(file.get(), buffer.data(), buffer.size())) > 0;) {
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  return nlohmann::json::parse(text);
}

Vec3d vec3(const nlohmann::json& v) { return {v.at(0), v.at(1), v.at(2)}; }

}  // namespace rayloc::test
