// Reads a reference file of tests/data/goldens.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace rayloc::test {

// `name` without ".json.gz". Throws when there is no such file.
nlohmann::json golden(const std::string& name);

}  // namespace rayloc::test
