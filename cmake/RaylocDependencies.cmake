# Every library comes from a Debian 12 package (deploy/packages/build.txt). Each has an imported target.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(tl-expected REQUIRED)    # tl::expected
find_package(Eigen3 REQUIRED)         # Eigen3::Eigen
find_package(Ceres REQUIRED)          # Ceres::ceres
find_package(TBB REQUIRED)            # TBB::tbb
find_package(embree 3 REQUIRED)       # embree
find_package(pugixml REQUIRED)        # pugixml::pugixml
find_package(tomlplusplus REQUIRED)   # tomlplusplus::tomlplusplus
find_package(CLI11 REQUIRED)          # CLI11::CLI11
find_package(spdlog REQUIRED)         # spdlog::spdlog
find_package(nlohmann_json REQUIRED)  # nlohmann_json::nlohmann_json
find_package(Protobuf REQUIRED)       # protobuf::libprotobuf, protobuf_generate_cpp
find_package(cppzmq REQUIRED)         # cppzmq
find_package(prometheus-cpp REQUIRED)   # prometheus-cpp::core
find_package(ZLIB REQUIRED)           # ZLIB::ZLIB
find_package(hwy REQUIRED)            # hwy::hwy
find_package(BLAS REQUIRED)           # BLAS::BLAS
find_package(LAPACK REQUIRED)         # LAPACK::LAPACK
find_library(DLIB_LIBRARY libdlib.a REQUIRED)  # engine/baselines/CMakeLists.txt states the reason for this one
pkg_check_modules(ASSIMP REQUIRED IMPORTED_TARGET assimp)       # PkgConfig::ASSIMP
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)          # PkgConfig::CAIRO
pkg_check_modules(CAPNG REQUIRED IMPORTED_TARGET libcap-ng)       # PkgConfig::CAPNG
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)  # PkgConfig::HTTPLIB
pkg_check_modules(MINIZIP REQUIRED IMPORTED_TARGET minizip)     # PkgConfig::MINIZIP
pkg_check_modules(NATS IMPORTED_TARGET libnats)                 # PkgConfig::NATS, for RAYLOC_CLUSTER
pkg_check_modules(PCAP REQUIRED IMPORTED_TARGET libpcap)         # PkgConfig::PCAP
pkg_check_modules(SODIUM REQUIRED IMPORTED_TARGET libsodium)     # PkgConfig::SODIUM
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)   # PkgConfig::SYSTEMD
if(RAYLOC_TESTS)
  find_package(GTest REQUIRED)        # GTest::gmock_main
  include(GoogleTest)
endif()
if(RAYLOC_BENCHMARKS)
  find_package(benchmark REQUIRED)    # benchmark::benchmark
endif()
