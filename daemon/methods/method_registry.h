// The registry of methods: the rows that this program was linked with (cmake/RaylocMethods.cmake).
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "daemon/methods/method.h"

namespace rayloc {

// The first is the default.
std::span<const Method* const> methods();
const Method& default_method();
// Null: there is none of that name.
const Method* find_method(std::string_view name);

// In the order of the rows.
std::span<const std::string_view> method_names();

// A line a method, for --help: its name, what it does, what it needs and whose it is.
std::string methods_help();

// Written by the build from the rows that the program is linked with; for method_registry.cpp.
std::span<const Method* const> method_table();

}  // namespace rayloc
