# Compiler settings, and the functions that declare the libraries and programs of this project.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

find_program(RAYLOC_CCACHE ccache)
if(RAYLOC_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${PROJECT_SOURCE_DIR}/cmake/compiler_cache")
endif()

# Several sources of a target compile as one: headers take most of a source's compile time. Off for an
# editor or clang-tidy, which read each source separately.
option(RAYLOC_UNITY "Compile up to eight sources of a target as one" ON)
set(CMAKE_UNITY_BUILD ${RAYLOC_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)

# No path of the checkout enters an object through __FILE__ or debug information, so that another checkout finds
# the object in the cache.
add_compile_options("-ffile-prefix-map=${PROJECT_SOURCE_DIR}/=")

# Debug information is a third of the build time and most of the link time; -g1 keeps the line
# numbers of stack traces.
string(REPLACE "-g" "-g1" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")

# The static libraries are also linked into the Python module (python/README.md), which is a shared library.
# All sources, also programs, use the same options. Hidden symbols are called directly, as in a program:
# tests/bench/trace_bench shows no difference.
add_compile_options(-fPIC -fvisibility=hidden)

# A hundred programs are linked against the same libraries; gold takes half of ld's time. With
# sanitizers it warns of their symbols that it does not export.
find_program(RAYLOC_GOLD ld.gold)
if(RAYLOC_GOLD AND NOT RAYLOC_SANITIZE)
  add_link_options(-fuse-ld=gold)
endif()

add_library(rayloc_warnings INTERFACE)
target_compile_options(rayloc_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
  -Wold-style-cast -Wnon-virtual-dtor
  # Replays are byte-identical: the compiler must not choose where to contract operations.
  -ffp-contract=off
  # GCC 12 reports a memcpy in std::string's operator+ at -O3 that cannot occur (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(RAYLOC_SANITIZE)
  # With sanitizers GCC cannot track the members that std::regex initialises (gcc(1), -fsanitize).
  target_compile_options(rayloc_warnings INTERFACE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()
if(RAYLOC_WERROR)
  target_compile_options(rayloc_warnings INTERFACE -Werror)
endif()
target_include_directories(rayloc_warnings INTERFACE "${PROJECT_SOURCE_DIR}")

if(RAYLOC_SANITIZE)
  if(RAYLOC_SANITIZE MATCHES "thread" AND RAYLOC_SANITIZE MATCHES "address")
    message(FATAL_ERROR "RAYLOC_SANITIZE: thread and address exclude each other")
  endif()
  # -O1: these builds serve to find faults, and take half the time of a test run.
  add_compile_options(-O1 -fsanitize=${RAYLOC_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${RAYLOC_SANITIZE})
endif()
if(RAYLOC_FUZZ AND NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "RAYLOC_FUZZ needs clang (preset fuzz)")
endif()

# rayloc_compile(TARGET [TEST]): the options for the part of the tree that contains the current folder.
function(rayloc_compile target)
  if(RAYLOC_FUZZ AND NOT "TEST" IN_LIST ARGN)  # the tests themselves need no coverage, and compile a fifth faster
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  # Only engine/ computes; other tests spend their time in the libraries, or waiting.
  if(NOT CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/(tests/)?engine(/|$)"
     AND ("TEST" IN_LIST ARGN OR RAYLOC_SANITIZE))
    target_compile_options(${target} PRIVATE -O0)
  endif()
endfunction()

# rayloc_library(NAME SOURCES file... [DEPENDS target...]): one folder, one static library.
function(rayloc_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE rayloc_warnings PUBLIC ${ARG_DEPENDS})
    target_include_directories(${name} PUBLIC "${PROJECT_SOURCE_DIR}")
    rayloc_compile(${name})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE ${ARG_DEPENDS})
    target_include_directories(${name} INTERFACE "${PROJECT_SOURCE_DIR}")
  endif()
endfunction()

# rayloc_program(NAME SOURCES file... [DEPENDS target...])
function(rayloc_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rayloc_warnings ${ARG_DEPENDS})
  rayloc_compile(${name})
endfunction()
