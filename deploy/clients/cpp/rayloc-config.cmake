# find_package(rayloc): the target rayloc::client. Needs Debian's libprotobuf-dev and libzmq3-dev.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(Protobuf)
find_dependency(PkgConfig)
pkg_check_modules(rayloc_zmq REQUIRED QUIET IMPORTED_TARGET libzmq)
include("${CMAKE_CURRENT_LIST_DIR}/rayloc-targets.cmake")
