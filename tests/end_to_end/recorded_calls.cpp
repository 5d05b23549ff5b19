// Preloaded into tchat: writes down, in the file that RECORDED_CALLS names, what it does to ordinary files and to the
// names in folders, one call a line: "open FILE" (a new one), "write FILE", "cut FILE", "sync FILE", "rename FROM TO",
// "link FROM TO", "remove FILE". With KILLED_AT = N in the environment it is killed just before the N-th of them.
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

const pid_t process = ::getpid();
std::atomic<long> calls = 0;

void note(const char* what, const char* one, const char* two = "") {
  const char* const last = std::getenv("KILLED_AT");
  if (++calls == (last != nullptr ? std::atol(last) : 0)) ::syscall(SYS_kill, process, SIGKILL);
  const char* const log = std::getenv("RECORDED_CALLS");
  if (log == nullptr) return;
  char line[1024];
  const int size = std::snprintf(line, sizeof line, "%s %s %s\n", what, one, two);
  const long file = ::syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0 || size <= 0) return;
  ::syscall(SYS_write, file, line, static_cast<std::size_t>(size));
  ::syscall(SYS_close, file);
}

void note_descriptor(const char* what, int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))) return;
  char link[64], path[512] = {};
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  if (::readlink(link, path, sizeof path - 1) > 0) note(what, path);
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* text, size_t size) {
  note_descriptor("write", descriptor);
  return ::syscall(SYS_write, descriptor, text, size);
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if ((flags & O_CREAT) != 0 && ::faccessat(AT_FDCWD, path, F_OK, AT_SYMLINK_NOFOLLOW) != 0) note("open", path);
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

int ftruncate(int descriptor, off_t size) noexcept {
  note_descriptor("cut", descriptor);
  return static_cast<int>(::syscall(SYS_ftruncate, descriptor, size));
}

int fsync(int descriptor) {
  note_descriptor("sync", descriptor);
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

int rename(const char* from, const char* to) noexcept {
  note("rename", from, to);
  return next<int (*)(const char*, const char*)>("rename")(from, to);
}

int link(const char* from, const char* to) noexcept {
  note("link", from, to);
  return next<int (*)(const char*, const char*)>("link")(from, to);
}

int unlink(const char* path) noexcept {
  if (::faccessat(AT_FDCWD, path, F_OK, AT_SYMLINK_NOFOLLOW) == 0) note("remove", path);
  return next<int (*)(const char*)>("unlink")(path);
}

int remove(const char* path) noexcept {
  if (::faccessat(AT_FDCWD, path, F_OK, AT_SYMLINK_NOFOLLOW) == 0) note("remove", path);
  return next<int (*)(const char*)>("remove")(path);
}
}
