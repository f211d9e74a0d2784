// Runs a program under the filters that systemd makes of SystemCallFilter=,
// SystemCallErrorNumber=EPERM, MemoryDenyWriteExecute=, RestrictAddressFamilies=,
// RestrictNamespaces=yes, RestrictRealtime=yes and LockPersonality=yes.
//   seccomp_launcher ALLOWED_CALLS FAMILY[,FAMILY] PROGRAM [ARGUMENT...]
// ALLOWED_CALLS: a file with the name of a system call per line; all others fail with EPERM.
// FAMILY: a number (AF_UNIX is 1). No privilege is needed: it sets no_new_privs.
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/personality.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

[[noreturn]] void fail(const char* what) {
  std::perror(what);
  std::exit(99);
}

void allow_calls(scmp_filter_ctx filter, const char* file) {
  std::ifstream names(file);
  int allowed = 0;
  for (std::string name; names >> name;) {
    const int call = seccomp_syscall_resolve_name(name.c_str());
    // Calls of other architectures, and those that are filtered by their arguments below.
    if (call < 0 || name == "mmap" || name == "mprotect") {
      continue;
    }
    if (seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0) != 0) {
      fail(name.c_str());
    }
    ++allowed;
  }
  if (allowed < 100) {
    fail("too few calls are allowed");
  }
}

// As systemd's seccomp_restrict_address_families(): other families fail with EAFNOSUPPORT.
void restrict_families(const std::string& list) {
  std::set<scmp_datum_t> allowed;
  std::istringstream families(list);
  for (std::string family; std::getline(families, family, ',');) {
    allowed.insert(std::stoull(family));
  }
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  constexpr std::uint32_t kRefuse = SCMP_ACT_ERRNO(EAFNOSUPPORT);
  constexpr scmp_datum_t kFamilies = AF_MAX;
  int failed = seccomp_rule_add(
      filter, kRefuse, SCMP_SYS(socket), 1, scmp_arg_cmp{0, SCMP_CMP_GE, kFamilies, 0});
  for (scmp_datum_t family = 0; family < kFamilies; ++family) {
    if (allowed.count(family) == 0) {
      failed |= seccomp_rule_add(
          filter, kRefuse, SCMP_SYS(socket), 1, scmp_arg_cmp{0, SCMP_CMP_EQ, family, 0});
    }
  }
  if (failed != 0 || seccomp_load(filter) != 0) {
    fail("address families");
  }
  seccomp_release(filter);
}

// As systemd's seccomp_restrict_namespaces(). glibc makes threads by clone() when there is no
// clone3(), whose arguments no filter sees.
int restrict_namespaces(scmp_filter_ctx filter) {
  constexpr std::uint32_t kRefuse = SCMP_ACT_ERRNO(EPERM);
  int failed = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
  failed |=
      seccomp_rule_add(filter, kRefuse, SCMP_SYS(setns), 1, scmp_arg_cmp{1, SCMP_CMP_EQ, 0, 0});
  for (const int flag : {CLONE_NEWCGROUP,
                         CLONE_NEWIPC,
                         CLONE_NEWNET,
                         CLONE_NEWNS,
                         CLONE_NEWPID,
                         CLONE_NEWUSER,
                         CLONE_NEWUTS}) {
    const auto bit = static_cast<scmp_datum_t>(flag);
    const scmp_arg_cmp first{0, SCMP_CMP_MASKED_EQ, bit, bit};
    const scmp_arg_cmp second{1, SCMP_CMP_MASKED_EQ, bit, bit};
    failed |= seccomp_rule_add(filter, kRefuse, SCMP_SYS(unshare), 1, first);
    failed |= seccomp_rule_add(filter, kRefuse, SCMP_SYS(clone), 1, first);
    failed |= seccomp_rule_add(filter, kRefuse, SCMP_SYS(setns), 1, second);
  }
  return failed;
}

// As systemd's seccomp_restrict_realtime() and seccomp_lock_personality().
int restrict_scheduling_and_personality(scmp_filter_ctx filter) {
  constexpr std::uint32_t kRefuse = SCMP_ACT_ERRNO(EPERM);
  int failed = 0;
  for (const int policy : {SCHED_FIFO, SCHED_RR}) {
    failed |= seccomp_rule_add(filter,
                               kRefuse,
                               SCMP_SYS(sched_setscheduler),
                               1,
                               scmp_arg_cmp{1, SCMP_CMP_EQ, static_cast<scmp_datum_t>(policy), 0});
  }
  failed |= seccomp_rule_add(filter,
                             kRefuse,
                             SCMP_SYS(sched_setscheduler),
                             1,
                             scmp_arg_cmp{1, SCMP_CMP_GT, SCHED_IDLE, 0});
  constexpr auto kAsk = 0xffffffffU;
  const auto current = static_cast<scmp_datum_t>(personality(kAsk));
  failed |= seccomp_rule_add(
      filter, kRefuse, SCMP_SYS(personality), 1, scmp_arg_cmp{0, SCMP_CMP_NE, current, 0});
  return failed;
}

void restrict_what_every_unit_does() {
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  if (filter == nullptr || restrict_namespaces(filter) != 0 ||
      restrict_scheduling_and_personality(filter) != 0 || seccomp_load(filter) != 0) {
    fail("namespaces, scheduling and personality");
  }
  seccomp_release(filter);
}

// As systemd's seccomp_memory_deny_write_execute().
void allow_memory(scmp_filter_ctx filter) {
  constexpr scmp_datum_t kBoth = PROT_WRITE | PROT_EXEC;
  for (const scmp_datum_t protection :
       {scmp_datum_t{0}, scmp_datum_t{PROT_WRITE}, scmp_datum_t{PROT_EXEC}}) {
    if (seccomp_rule_add(filter,
                         SCMP_ACT_ALLOW,
                         SCMP_SYS(mmap),
                         1,
                         scmp_arg_cmp{2, SCMP_CMP_MASKED_EQ, kBoth, protection}) != 0) {
      fail("mmap");
    }
  }
  if (seccomp_rule_add(filter,
                       SCMP_ACT_ALLOW,
                       SCMP_SYS(mprotect),
                       1,
                       scmp_arg_cmp{2, SCMP_CMP_MASKED_EQ, PROT_EXEC, 0}) != 0) {
    fail("mprotect");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fputs("usage: seccomp_launcher ALLOWED_CALLS FAMILY[,FAMILY] PROGRAM ...\n", stderr);
    return 64;
  }
  restrict_families(argv[2]);
  restrict_what_every_unit_does();
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
  if (filter == nullptr) {
    fail("seccomp_init");
  }
  allow_calls(filter, argv[1]);
  allow_memory(filter);
  if (seccomp_load(filter) != 0) {
    fail("seccomp_load");
  }
  seccomp_release(filter);
  execvp(argv[3], argv + 3);
  fail(argv[3]);
}
