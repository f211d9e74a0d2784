// For the libraries of engine/.
#pragma once

#include <Eigen/Dense>

#include "cmake/precompiled/standard.h"
