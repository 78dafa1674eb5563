/* For LD_PRELOAD (test_host.py): every thread but the first works for a second or two on each of its messages. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>
int poll(struct pollfd *files, nfds_t n, int timeout)
{
  int (*real)(struct pollfd *, nfds_t, int) = (int (*)(struct pollfd *, nfds_t, int)) dlsym(RTLD_NEXT, "poll");
  int found = real(files, n, timeout);
  time_t begin = time(NULL);
  while (found > 0 && gettid() != getpid() && time(NULL) < begin + 2) {}
  return found;
}
