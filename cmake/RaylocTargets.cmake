# Compiler settings, and the three functions that declare every target of this project.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

find_program(RAYLOC_CCACHE ccache)
if(RAYLOC_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${RAYLOC_CCACHE}")
endif()

# Debug information is a third of the build time and most of the link time; -g1 keeps the line
# numbers of stack traces.
string(REPLACE "-g" "-g1" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")

# The static libraries also go into the Python module (python/README.md), which is a shared one. All
# is compiled alike, programs too, so that one precompiled header serves both. What stays hidden is
# called directly, as in a program: tests/bench/trace_bench sees no difference.
add_compile_options(-fPIC -fvisibility=hidden)

# A hundred programs are linked against the same libraries; gold takes half of ld's time. With
# sanitizers it warns of symbols of theirs that it does not export.
find_program(RAYLOC_GOLD ld.gold)
if(RAYLOC_GOLD AND NOT RAYLOC_SANITIZE)
  add_link_options(-fuse-ld=gold)
endif()

add_library(rayloc_warnings INTERFACE)
target_compile_options(rayloc_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion
  -Wold-style-cast -Wnon-virtual-dtor
  # Replays are byte-identical: no contraction whose place the compiler may choose.
  -ffp-contract=off
  # GCC 12 sees an impossible memcpy in std::string's operator+ at -O3 (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(RAYLOC_SANITIZE)
  # With sanitizers GCC loses track of what std::regex initialises (gcc(1), -fsanitize).
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
  # -O1: these builds are for findings, and take half the time of a test run.
  add_compile_options(-O1 -fsanitize=${RAYLOC_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${RAYLOC_SANITIZE})
endif()
if(RAYLOC_FUZZ AND NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "RAYLOC_FUZZ needs clang (preset fuzz)")
endif()

# rayloc_compile(TARGET [TEST]): the options and the precompiled header of its half of the tree, by the
# current folder.
function(rayloc_compile target)
  set(part daemon)
  if(CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/(tests/)?engine(/|$)")
    set(part engine)
  endif()
  set(header ${part})
  set(options "")
  if("TEST" IN_LIST ARGN)
    set(header ${part}_test)
  elseif(RAYLOC_FUZZ)  # the tests themselves need no coverage, and compile a fifth faster
    list(APPEND options -fsanitize=fuzzer-no-link)
  endif()
  # Only engine/ computes; what takes the time of tests is in the libraries, or waiting.
  if(part STREQUAL daemon AND ("TEST" IN_LIST ARGN OR RAYLOC_SANITIZE))
    list(APPEND options -O0)
  endif()
  target_compile_options(${target} PRIVATE ${options})
  rayloc_precompile(${target} ${header} ${options})
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

# Builds every test of the tree; `all` builds the programs as well.
add_custom_target(rayloc_tests)

# Tests of several trees meet in one summary (tests/run): those of a sanitizer's tree carry its name.
set(RAYLOC_TEST_PREFIX "")
if(RAYLOC_SANITIZE MATCHES "thread")
  set(RAYLOC_TEST_PREFIX "tsan.")
elseif(RAYLOC_SANITIZE)
  set(RAYLOC_TEST_PREFIX "asan.")
endif()

# rayloc_test(NAME SOURCES file... [DEPENDS target...] [LABELS label...] [FILES_ONLY] [WHOLE]): a
# GoogleTest program. The tests find the folder tests/data by RAYLOC_TEST_DATA, and the programs by
# RAYLOC_BIN. Labels: `threads` (the only tests built under ThreadSanitizer), `slow` and `e2e` (real
# processes, one at a time beside other tests unless FILES_ONLY says that nothing in them happens in
# real time; neither is built under a sanitizer), `replay`; `unit` when none is given. WHOLE: one
# entry of ctest, for a program whose tests share what takes them most of their time.
function(rayloc_test name)
  cmake_parse_arguments(ARG "FILES_ONLY;WHOLE" "" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rayloc_warnings ${ARG_DEPENDS} GTest::gmock_main)
  target_compile_definitions(${name} PRIVATE
    RAYLOC_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data"
    RAYLOC_BIN="${CMAKE_BINARY_DIR}/bin")
  rayloc_compile(${name} TEST)
  # A test that does not belong into this tree is a target that nothing builds, so that what a
  # folder says about it in addition holds everywhere.
  if(RAYLOC_SANITIZE AND ("e2e" IN_LIST ARG_LABELS OR "slow" IN_LIST ARG_LABELS))
    return()
  endif()
  if(RAYLOC_SANITIZE MATCHES "thread" AND NOT "threads" IN_LIST ARG_LABELS)
    return()
  endif()
  set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL FALSE)
  add_dependencies(rayloc_tests ${name})
  # ctest begins with what costs most: those in real time run one after the other, and all others
  # fit beside them, so no run is shorter than they are.
  set(lock "")
  set(cost 0)
  if("slow" IN_LIST ARG_LABELS OR RAYLOC_SANITIZE)
    set(cost 10)
  endif()
  if("e2e" IN_LIST ARG_LABELS)
    if(NOT ARG_FILES_ONLY)
      set(lock RESOURCE_LOCK real_time)
      set(cost 20)
    endif()
    add_dependencies(${name} rayloc raylocd)  # real processes, of this very build
  endif()
  if(RAYLOC_SANITIZE OR ARG_WHOLE)  # a start under a sanitizer takes longer than most tests
    add_test(NAME "${RAYLOC_TEST_PREFIX}${name}" COMMAND ${name} --gtest_brief=1)
    set_tests_properties("${RAYLOC_TEST_PREFIX}${name}" PROPERTIES LABELS "${ARG_LABELS}"
      COST ${cost} TIMEOUT 1200 ENVIRONMENT "XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/cache")
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
                       PROPERTIES TIMEOUT 300 COST ${cost} ${lock}
                       ENVIRONMENT "XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/cache")
  # gtest_discover_tests flattens lists, so several labels are set in a file that ctest reads next.
  set(labels_file "${CMAKE_CURRENT_BINARY_DIR}/${name}_labels.cmake")
  file(WRITE "${labels_file}"
       "set_tests_properties(\${${name}_TESTS} PROPERTIES LABELS \"${ARG_LABELS}\")\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${labels_file}")
endfunction()

# rayloc_fuzzer(NAME SOURCE file DEPENDS target...): a libFuzzer program under RAYLOC_FUZZ, in every
# other build a plain one; ctest replays tests/fuzz/corpus/NAME in both.
function(rayloc_fuzzer name)
  cmake_parse_arguments(ARG "" "SOURCE" "DEPENDS" ${ARGN})
  if(RAYLOC_SANITIZE MATCHES "thread")
    return()
  endif()
  add_executable(fuzz_${name} ${ARG_SOURCE})
  target_link_libraries(fuzz_${name} PRIVATE rayloc_warnings ${ARG_DEPENDS})
  set(replay -runs=0)  # libFuzzer: every input of the corpus once, no new ones
  if(RAYLOC_FUZZ)
    target_compile_options(fuzz_${name} PRIVATE -fsanitize=fuzzer-no-link)
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  else()
    target_sources(fuzz_${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests/fuzz/replay_corpus.cpp")
    set(replay)
  endif()
  add_dependencies(rayloc_tests fuzz_${name})
  set(test "${RAYLOC_TEST_PREFIX}fuzz_corpus.${name}")
  add_test(NAME ${test}
           COMMAND fuzz_${name} ${replay} "${PROJECT_SOURCE_DIR}/tests/fuzz/corpus/${name}")
  set_tests_properties(${test} PROPERTIES LABELS fuzz TIMEOUT 300)
endfunction()
