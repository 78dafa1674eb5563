/* For LD_PRELOAD (test_out_of_memory.py): a process in which malloc of MALLOC_LIMIT bytes and more, up to
 * MALLOC_MOST, has nothing to give, calloc likewise, and new of NEW_LIMIT and more, up to NEW_MOST, throws. Limits from
 * the environment, 0: none; they are those of rank SCARCE_RANK alone, if that is given. */
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" void *__libc_malloc(size_t);
extern "C" void *__libc_calloc(size_t, size_t);

static size_t limit_of(const char *name)
{
  const char *value = getenv(name), *scarce = getenv("SCARCE_RANK"), *me = getenv("OMPI_COMM_WORLD_RANK");
  if (!me) me = getenv("PMI_RANK");    // MPICH
  return value && (!scarce || (me && !strcmp(me, scarce))) ? strtoul(value, nullptr, 10) : 0;
}

extern "C" void *malloc(size_t bytes)
{
  static size_t limit = limit_of("MALLOC_LIMIT"), most = limit_of("MALLOC_MOST");
  return limit && bytes >= limit && (!most || bytes <= most) ? nullptr : __libc_malloc(bytes);
}

extern "C" void *calloc(size_t count, size_t each)
{
  static size_t limit = limit_of("CALLOC_LIMIT"), most = limit_of("CALLOC_MOST");
  const size_t bytes = count * each;
  return limit && bytes >= limit && (!most || bytes <= most) ? nullptr : __libc_calloc(count, each);
}

void *operator new(size_t bytes)
{
  static size_t limit = limit_of("NEW_LIMIT"), most = limit_of("NEW_MOST");
  const bool scarce = limit && bytes >= limit && (!most || bytes <= most);
  void *memory = scarce ? nullptr : __libc_malloc(bytes ? bytes : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}
