// For the tests of engine/.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "cmake/precompiled/standard.h"
