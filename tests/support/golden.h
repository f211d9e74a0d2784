// Reads a reference file of tests/data/goldens.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "engine/base/vec3.h"

namespace rayloc::test {

// `name` without ".json.gz". Throws when there is no such file.
nlohmann::json golden(const std::string& name);

// [x, y, z].
Vec3d vec3(const nlohmann::json& v);

}  // namespace rayloc::test
