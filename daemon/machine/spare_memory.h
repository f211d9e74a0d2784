// What the allocator keeps of memory that nothing uses any more, for the next time.
//
// Whenever a stage is behind (the machine was busy, a disk or a subscriber slow), its queue holds
// for a moment what it holds at no other time. Left alone, glibc keeps nearly all of that for ever:
// what a busy minute once needed would look like a leak. So there are two rules, and each needs the
// other: the end of a heap goes at once when it is free, and what is free in between every few
// seconds.
#pragma once

#include <chrono>

namespace rayloc {

// The first rule. To be called before there is a second thread.
void bound_spare_memory();

// The second one: to be called every kSpareInterval. It takes some milliseconds, during which
// other threads may wait to allocate.
void give_spare_memory_back();
constexpr std::chrono::seconds kSpareInterval{10};

}  // namespace rayloc
