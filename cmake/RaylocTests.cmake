# Declares tests, and with each its tier (tests/README.md): the gate runs the tests without the label `nightly`.
#
# Labels of a test:
#   unit, threads, fuzz, lint, package, e2e   its kind; ThreadSanitizer runs `threads` alone
#   FOLDER                                    the folder of tests/ that declares it, for tests/run --fast
#   slow      takes long under a sanitizer, and is not built there
#   realtime  its result depends on the pace of real processes: runs alone, and is repeated once when it fails
#   contract  a real-time test of behaviour that users rely on: in the gate
#   nightly   only in tests/run --all
#   daily     also in tests/run --fast

# Builds every test of the tree; `all` builds the programs as well.
add_custom_target(rayloc_tests)

# Factor of every deadline of a test; tests/run measures the machine and sets it.
set(RAYLOC_PATIENCE 1 CACHE STRING "Factor of the deadlines of tests, 1 or more")

# Tests of several trees are listed in one summary (tests/run): those of a sanitizer's tree have its name.
set(RAYLOC_TEST_PREFIX "")
if(RAYLOC_SANITIZE MATCHES "thread")
  set(RAYLOC_TEST_PREFIX "tsan.")
elseif(RAYLOC_SANITIZE)
  set(RAYLOC_TEST_PREFIX "asan.")
endif()

# rayloc_test_labels(OUT label...): the labels, with those implied by them and by the current folder.
function(rayloc_test_labels out)
  file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}/tests" "${CMAKE_CURRENT_SOURCE_DIR}")
  set(labels ${ARGN} ${folder})
  if("contract" IN_LIST labels OR "daily" IN_LIST labels)
    list(APPEND labels realtime)
  endif()
  list(REMOVE_DUPLICATES labels)
  set(${out} "${labels}" PARENT_SCOPE)
endfunction()

# rayloc_whole_program(NAME ENTRY FILTER COST label...): the tests of a program that the GoogleTest filter selects, as
# one entry of ctest.
function(rayloc_whole_program name entry filter cost)
  math(EXPR timeout "1200 * ${RAYLOC_PATIENCE}")
  set(entry "${RAYLOC_TEST_PREFIX}${entry}")
  add_test(NAME ${entry} COMMAND ${name} --gtest_brief=1 "--gtest_filter=${filter}")
  set_tests_properties(${entry} PROPERTIES LABELS "${ARGN}" COST ${cost} TIMEOUT ${timeout}
    ENVIRONMENT "XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/cache")
endfunction()

# rayloc_check_test_patterns(NAME PATTERNS pattern... SOURCES file...): ends the configuration if a pattern selects no test
# of the sources. Renaming a test would otherwise move it into the gate without a notice.
function(rayloc_check_test_patterns name)
  cmake_parse_arguments(ARG "" "" "PATTERNS;SOURCES" ${ARGN})
  if(NOT ARG_PATTERNS)
    return()
  endif()
  set(tests)
  foreach(source IN LISTS ARG_SOURCES)
    file(REAL_PATH "${source}" path)
    file(READ "${path}" text)
    string(REGEX MATCHALL "TEST(_F|_P)?\\([ \n]*[A-Za-z0-9_]+,[ \n]*[A-Za-z0-9_]+" found "${text}")
    list(TRANSFORM found REPLACE "TEST(_F|_P)?\\([ \n]*([A-Za-z0-9_]+),[ \n]*" "\\2.")
    list(APPEND tests ${found})
  endforeach()
  foreach(pattern IN LISTS ARG_PATTERNS)
    string(REGEX REPLACE "^[*A-Za-z0-9_]+/" "" regex "${pattern}")  # without the name of an instantiation
    string(REGEX REPLACE "/.*$" "" regex "${regex}")                # and the parameter
    if(NOT regex MATCHES "\\[\\.\\]")  # a glob
      string(REPLACE "." "[.]" regex "${regex}")
      string(REPLACE "*" ".*" regex "${regex}")
    endif()
    set(selected ${tests})
    list(FILTER selected INCLUDE REGEX "^(${regex})")
    if(NOT selected)
      message(SEND_ERROR "${name}: no test is named like '${pattern}'; its test may have another name now")
    endif()
  endforeach()
endfunction()

# rayloc_test(NAME SOURCES file... [DEPENDS target...] [LABELS label...] [FILES_ONLY] [WHOLE] [CALIBRATED_SITE]
#             [CONTRACT regex...] [NIGHTLY regex...] [DAILY regex] [SANITIZED_NIGHTLY glob...]): a GoogleTest program.
# Its tests find tests/data and the programs with tests/support/test_paths.h.
#   LABELS      `unit` when none is given; `e2e` (real processes; not built under a sanitizer) is also `realtime`
#   FILES_ONLY  an e2e program that reads and writes files, without any real-time behaviour
#   WHOLE       one entry of ctest, for a program whose tests share their most expensive set-up
#   CALIBRATED_SITE  its tests share the bundled site, calibrated once (tests/e2e/make_calibrated_site)
#   CONTRACT    the real-time tests of the program that the gate runs; its others are `nightly`
#   NIGHTLY     the tests of the program that only tests/run --all runs: regular expressions, or globs of GoogleTest
#               where it is WHOLE
#   DAILY       the real-time tests that tests/run --fast runs as well
#   SANITIZED_NIGHTLY  the tests (globs of GoogleTest) that only tests/run --all runs under a sanitizer, where each
#                      takes several seconds; "*" for the whole program
function(rayloc_test name)
  cmake_parse_arguments(ARG "CALIBRATED_SITE;FILES_ONLY;WHOLE" "DAILY"
                        "SOURCES;DEPENDS;LABELS;CONTRACT;NIGHTLY;SANITIZED_NIGHTLY" ${ARGN})
  rayloc_check_test_patterns(${name} SOURCES ${ARG_SOURCES}
                             PATTERNS ${ARG_CONTRACT} ${ARG_NIGHTLY} ${ARG_SANITIZED_NIGHTLY})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if("e2e" IN_LIST ARG_LABELS AND NOT ARG_FILES_ONLY)
    list(APPEND ARG_LABELS realtime)
  endif()
  rayloc_test_labels(labels ${ARG_LABELS})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE rayloc_warnings rayloc_test_paths ${ARG_DEPENDS} GTest::gmock_main)
  rayloc_compile(${name} TEST)
  # A test that is not part of this tree is a target that is never built, so that further
  # statements of a folder about it remain valid.
  if(RAYLOC_SANITIZE AND ("e2e" IN_LIST labels OR "slow" IN_LIST labels))
    return()
  endif()
  if(RAYLOC_SANITIZE MATCHES "thread" AND NOT "threads" IN_LIST labels)
    return()
  endif()
  set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL FALSE)
  add_dependencies(rayloc_tests ${name})
  if("e2e" IN_LIST labels)
    add_dependencies(${name} rayloc raylocd)  # real processes, of this build
  endif()
  set(cost 0)
  if("slow" IN_LIST labels OR RAYLOC_SANITIZE)
    set(cost 10)  # ctest starts the longest tests first
  endif()
  if(RAYLOC_SANITIZE OR ARG_WHOLE)  # a start under a sanitizer takes longer than most tests
    set(only_nightly ${ARG_NIGHTLY})
    if(RAYLOC_SANITIZE)
      set(only_nightly ${ARG_SANITIZED_NIGHTLY})
    endif()
    if(NOT only_nightly)
      rayloc_whole_program(${name} "${name}" "*" ${cost} ${labels})
    elseif(only_nightly STREQUAL "*")
      rayloc_whole_program(${name} "${name}" "*" ${cost} ${labels} nightly)
    else()
      list(JOIN only_nightly ":" long)
      rayloc_whole_program(${name} "${name}" "-${long}" ${cost} ${labels})
      rayloc_whole_program(${name} "${name}.long" "${long}" ${cost} ${labels} nightly)
    endif()
    return()
  endif()
  math(EXPR timeout "300 * ${RAYLOC_PATIENCE}")
  list(JOIN ARG_CONTRACT "|" contract)
  list(JOIN ARG_NIGHTLY "|" nightly)
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
                       PROPERTIES TIMEOUT ${timeout} COST ${cost}
                       ENVIRONMENT "XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/cache")
  # gtest_discover_tests flattens lists, so several labels are set in a file that ctest reads afterwards.
  set(labels_file "${CMAKE_CURRENT_BINARY_DIR}/${name}_labels.cmake")
  file(CONFIGURE OUTPUT "${labels_file}" @ONLY CONTENT [[
foreach(test IN LISTS @name@_TESTS)
  set(labels "@labels@")
  if(NOT "@contract@" STREQUAL "")
    if(test MATCHES "^(@contract@)")
      list(APPEND labels contract)
    else()
      list(APPEND labels nightly)
    endif()
  endif()
  if(NOT "@nightly@" STREQUAL "" AND test MATCHES "^(@nightly@)")
    list(APPEND labels nightly)
  endif()
  if(NOT "@ARG_DAILY@" STREQUAL "" AND test MATCHES "@ARG_DAILY@")
    list(APPEND labels daily)
  endif()
  set_tests_properties("${test}" PROPERTIES LABELS "${labels}")
  if("@ARG_CALIBRATED_SITE@" STREQUAL "TRUE")
    set_tests_properties("${test}" PROPERTIES FIXTURES_REQUIRED calibrated_site
      ENVIRONMENT "XDG_CACHE_HOME=@CMAKE_BINARY_DIR@/cache;RAYLOC_CALIBRATED_SITE=@CMAKE_BINARY_DIR@/calibrated_site")
  endif()
endforeach()
]])
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${labels_file}")
endfunction()

# rayloc_script_test(NAME LABELS label... [TIMEOUT seconds] [ENVIRONMENT VAR=value...] COMMAND word...): a script
# or a program as one entry of ctest, in the tree without sanitizers. Exit status 77 skips it.
function(rayloc_script_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "LABELS;ENVIRONMENT;COMMAND" ${ARGN})
  if(RAYLOC_SANITIZE)
    return()
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  math(EXPR timeout "${ARG_TIMEOUT} * ${RAYLOC_PATIENCE}")
  rayloc_test_labels(labels ${ARG_LABELS})
  add_test(NAME ${name} COMMAND ${ARG_COMMAND})
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT ${timeout} SKIP_RETURN_CODE 77
    ENVIRONMENT "XDG_CACHE_HOME=${CMAKE_BINARY_DIR}/cache;PYTHONDONTWRITEBYTECODE=1;${ARG_ENVIRONMENT}")
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
  math(EXPR timeout "300 * ${RAYLOC_PATIENCE}")
  set_tests_properties(${test} PROPERTIES LABELS fuzz TIMEOUT ${timeout})
endfunction()
