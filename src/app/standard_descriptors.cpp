#include "app/standard_descriptors.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <initializer_list>

namespace tchat {

void occupy_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0) continue;
    const int wrong_way = descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    // The lowest free number is taken, and all below this one are in use.
    if (::open("/dev/null", wrong_way) != descriptor) return;  // without /dev/null there is nothing to put there
  }
}

}  // namespace tchat
