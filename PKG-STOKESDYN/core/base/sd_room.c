#ifdef __linux__
#define _DEFAULT_SOURCE
#include <sys/mman.h>
#endif

#include "sd_room.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* --- large pages --- */

#ifdef MADV_HUGEPAGE
static const size_t page = (size_t) 2 << 20;

/* Asks for the whole large pages of a block; a refusal changes nothing. */
static void ask_for_pages(void *block, size_t bytes)
{
  const uintptr_t first = ((uintptr_t) block + page - 1) / page * page, end = ((uintptr_t) block + bytes) / page * page;
  if (end > first) (void) madvise((void *) first, end - first, MADV_HUGEPAGE);
}

/* The last page is a large one if at least half of it is wanted: small ones take no memory before they are
 * written to. */
static void *room_of(size_t bytes)
{
  if (bytes < page / 2 || bytes > SIZE_MAX - page) return malloc(bytes);
  void *block = aligned_alloc(page, (bytes + page - 1) / page * page);
  if (block) ask_for_pages(block, (bytes + page / 2) / page * page);
  return block;
}
#else
static void ask_for_pages(void *block, size_t bytes)
{
  (void) block;
  (void) bytes;
}

static void *room_of(size_t bytes)
{
  return malloc(bytes);
}
#endif

/* --- arrays --- */

int sd_grow(void *array, size_t size, size_t count)
{
  void *old;
  memcpy(&old, array, sizeof(old)); /* a pointer of another type may not be read as one to void */
  void *larger = realloc(old, size * (count + 1));
  if (!larger) return 0;
  memcpy(array, &larger, sizeof(larger));
  ask_for_pages(larger, size * (count + 1));
  return 1;
}

int sd_extend(void *array, size_t size, size_t count, size_t *room)
{
  if (count <= *room) return 1;
  const size_t wanted = count + *room / 4 + 64;
  if (!sd_grow(array, size, wanted)) return 0;
  *room = wanted;
  return 1;
}

/* What has to grow once will again: then an eighth more than is asked for. */
int sd_reserve(void *array, size_t size, size_t count, size_t *room)
{
  void *block;
  memcpy(&block, array, sizeof(block));
  if (block && count <= *room) return 1;
  if (block) count += count / 8;
  free(block);
  block = room_of(size * (count + 1));
  memcpy(array, &block, sizeof(block));
  *room = block ? count : 0;
  return block != NULL;
}

double *sd_reserve_lines(double **block, size_t count, size_t *room)
{
  if (!sd_reserve(block, sizeof(double), count + 8, room)) return NULL;
  return (double *) (((uintptr_t) *block + 63) & ~(uintptr_t) 63);
}
