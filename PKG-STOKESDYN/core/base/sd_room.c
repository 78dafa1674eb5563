#include "sd_room.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int sd_grow(void *array, size_t size, size_t count)
{
  void *old;
  memcpy(&old, array, sizeof(old)); /* a pointer of another type may not be read as one to void */
  void *larger = realloc(old, size * (count + 1));
  if (larger) memcpy(array, &larger, sizeof(larger));
  return larger != NULL;
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
  block = malloc(size * (count + 1));
  memcpy(array, &block, sizeof(block));
  *room = block ? count : 0;
  return block != NULL;
}

double *sd_reserve_lines(double **block, size_t count, size_t *room)
{
  if (!sd_reserve(block, sizeof(double), count + 8, room)) return NULL;
  return (double *) (((uintptr_t) *block + 63) & ~(uintptr_t) 63);
}
