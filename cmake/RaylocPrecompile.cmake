# Precompiled headers for the builds that run tests (RAYLOC_PRECOMPILE, set by their presets). What is
# installed is built without, and tests/lint/tidy reads without them: a source that leans on them for
# an include fails there.

option(RAYLOC_PRECOMPILE "Precompile the headers that most sources include" OFF)

# What ccache needs in order to keep what was compiled with them (ccache(1), Precompiled headers).
if(RAYLOC_PRECOMPILE AND RAYLOC_CCACHE)
  set(RAYLOC_PRECOMPILE_OPTIONS "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>"
      "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()

# rayloc_precompile(TARGET HEADER [option...]): its sources see cmake/precompiled/HEADER.h, which is
# compiled once for all targets that name it; `option`: those of the target that all of these share.
function(rayloc_precompile target header)
  if(NOT RAYLOC_PRECOMPILE)
    return()
  endif()
  set(shared rayloc_precompiled_${header})
  if(NOT TARGET ${shared})
    add_library(${shared} OBJECT EXCLUDE_FROM_ALL "${PROJECT_SOURCE_DIR}/cmake/precompiled/empty.cpp")
    target_link_libraries(${shared} PRIVATE rayloc_warnings Eigen3::Eigen tl::expected
                          nlohmann_json::nlohmann_json)
    if(header MATCHES "_test$")
      target_link_libraries(${shared} PRIVATE GTest::gmock)
    endif()
    target_compile_options(${shared} PRIVATE ${ARGN} ${RAYLOC_PRECOMPILE_OPTIONS})
    target_precompile_headers(${shared} PRIVATE "${PROJECT_SOURCE_DIR}/cmake/precompiled/${header}.h")
  endif()
  # For GCC what comes from a precompiled header is no system header any more, and GCC 12 sees a copy
  # beyond an array, which is never made, in std::string's operator+.
  target_compile_options(${target} PRIVATE ${RAYLOC_PRECOMPILE_OPTIONS}
    "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread>")
  target_precompile_headers(${target} REUSE_FROM ${shared})
endfunction()
