/* Arrays that grow. array is the address of a pointer of any type, NULL or from malloc; size is
 * that of an element in bytes. All return 1, or 0: out of memory.
 *
 * Of those of 1 MB and more Linux is asked for pages of 2 MB, where it gives them to who asks: a processor
 * remembers where few pages are, and what one rank sends another on the same machine is looked up page by
 * page. */
#ifndef SD_ROOM_H
#define SD_ROOM_H

#include <stddef.h>

#include "sd_extern_c.h"

SD_BEGIN_C

/* Room for count elements behind *array, which keeps those it has; out of memory: as before. */
int sd_grow(void *array, size_t size, size_t count);

/* The same where elements are added bit by bit: *room is the number of elements that there is room for,
 * and grows by a quarter at least. */
int sd_extend(void *array, size_t size, size_t count, size_t *room);

/* Room for count elements whose values do not matter: nothing happens where *room, the number of
 * elements that there is room for, is enough. Out of memory: *array is NULL, *room 0. */
int sd_reserve(void *array, size_t size, size_t count, size_t *room);

/* The same of doubles that begin on a border of cache lines, NULL: out of memory. *block is for free(). */
double *sd_reserve_lines(double **block, size_t count, size_t *room);

SD_END_C
#endif
