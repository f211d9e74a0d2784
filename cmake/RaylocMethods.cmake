# Methods of localization: table rows that are linked into a program (daemon/methods/README.md).

# rayloc_method(NAME [APART] SOURCES file... [DEPENDS target...]): the library rayloc_method_NAME. One
# of its sources defines `const Method& NAME_method()` in namespace rayloc: the row. It belongs to the
# product unless it is declared APART.
function(rayloc_method name)
  cmake_parse_arguments(ARG "APART" "" "SOURCES;DEPENDS" ${ARGN})
  rayloc_library(rayloc_method_${name} SOURCES ${ARG_SOURCES}
                 DEPENDS rayloc_method_interface ${ARG_DEPENDS})
  if(NOT ARG_APART)
    set_property(GLOBAL APPEND PROPERTY RAYLOC_METHODS ${name})
  endif()
endfunction()

# rayloc_method_table(TARGET [NAME...]): the library TARGET, which defines method_table() with the rows
# of the product in the order in which they were declared, then those of the methods NAME.
function(rayloc_method_table target)
  get_property(methods GLOBAL PROPERTY RAYLOC_METHODS)
  list(APPEND methods ${ARGN})
  set(declarations "")
  set(rows "")
  foreach(name IN LISTS methods)
    string(APPEND declarations "const Method& ${name}_method();\n")
    string(APPEND rows "      &${name}_method(),\n")
  endforeach()
  set(file "${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp")
  file(CONFIGURE OUTPUT "${file}" @ONLY CONTENT [[
// Written by cmake/RaylocMethods.cmake.
#include <array>

#include "daemon/methods/method_registry.h"

namespace rayloc {

@declarations@
std::span<const Method* const> method_table() {
  static const std::array kRows = std::to_array<const Method*>({
@rows@  });
  return kRows;
}

}  // namespace rayloc
]])
  list(TRANSFORM methods PREPEND rayloc_method_ OUTPUT_VARIABLE libraries)
  rayloc_library(${target} SOURCES "${file}" DEPENDS ${libraries})
endfunction()

# rayloc_program_with(NAME PROGRAM METHOD...): the target NAME links the objects of PROGRAM with a table
# of the rows of the product and of the methods METHOD. Nothing is compiled twice. The program
# has the same name, in the folder with_METHOD beside it.
function(rayloc_program_with name program)
  string(REPLACE ";" "_" added "${ARGN}")
  if(NOT TARGET rayloc_method_table_with_${added})
    rayloc_method_table(rayloc_method_table_with_${added} ${ARGN})
  endif()
  get_target_property(libraries ${program} LINK_LIBRARIES)
  # The table comes first, so that the linker does not use the table of the product.
  add_executable(${name} EXCLUDE_FROM_ALL $<TARGET_OBJECTS:${program}>
                 $<TARGET_OBJECTS:rayloc_method_table_with_${added}>)
  target_link_libraries(${name} PRIVATE ${libraries} rayloc_method_table_with_${added})
  set_target_properties(${name} PROPERTIES OUTPUT_NAME ${program}
                        RUNTIME_OUTPUT_DIRECTORY "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/with_${added}")
endfunction()
