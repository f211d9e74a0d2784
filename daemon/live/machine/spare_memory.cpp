#include "daemon/live/machine/spare_memory.h"

#include <malloc.h>
#include <sys/resource.h>

namespace rayloc {
namespace {

// [bytes] that may be free at the end of a heap. If unset it is twice the largest mapped block that
// was ever freed, up to 64 MiB: reading a file of path grids raises it to that.
constexpr int kFreeEnd = 1 << 20;
// [bytes] from which on a block is mapped, and unmapped when it is freed. With the one above unset
// it grows in the same manner; with the one above set alone, it would stay at 128 KiB, and the
// vectors of each fix would be mapped anew.
constexpr int kMappedBlock = 4 << 20;
// Heaps under a limit of address space (ulimit -v); each takes 64 MiB at once, which the stacks of
// further threads would need.
constexpr int kHeapsUnderALimit = 2;

bool address_space_is_limited() {
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

void bound_spare_memory() {
  mallopt(M_TRIM_THRESHOLD, kFreeEnd);
  mallopt(M_MMAP_THRESHOLD, kMappedBlock);
  if (address_space_is_limited()) {
    mallopt(M_ARENA_MAX, kHeapsUnderALimit);
  }
}

void give_spare_memory_back() { malloc_trim(0); }

}  // namespace rayloc
