// For capture/ and daemon/.
#pragma once

#include <nlohmann/json.hpp>

#include "cmake/precompiled/standard.h"
