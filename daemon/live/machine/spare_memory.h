// Unused memory that the allocator keeps for later allocations.
//
// Whenever a stage is behind (the machine was busy, a disk or a subscriber slow), its queue is
// temporarily larger than at any other time. By default, glibc keeps nearly all of that memory for
// ever: the demand of a busy minute would appear as a leak. There are therefore two rules, and each
// needs the other: the free end of a heap is returned immediately, and free memory in between every
// few seconds.
#pragma once

#include <chrono>

namespace rayloc {

// The first rule. To be called before there is a second thread.
void bound_spare_memory();

// The second one: to be called every kSpareInterval. It takes some milliseconds, during which other
// threads may wait to allocate.
void give_spare_memory_back();
constexpr std::chrono::seconds kSpareInterval{10};

}  // namespace rayloc
