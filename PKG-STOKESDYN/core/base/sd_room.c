#include "sd_room.h"

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
