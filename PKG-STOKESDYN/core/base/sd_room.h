/* Arrays that grow. array is the address of a pointer of any type, NULL or from malloc; size is
 * that of an element in bytes. Both return 1, or 0: out of memory. */
#ifndef SD_ROOM_H
#define SD_ROOM_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Room for count elements behind *array, which keeps those it has; out of memory: as before. */
int sd_grow(void *array, size_t size, size_t count);

/* Room for count elements whose values do not matter: nothing happens where *room, the number of
 * elements that there is room for, is enough. Out of memory: *array is NULL, *room 0. */
int sd_reserve(void *array, size_t size, size_t count, size_t *room);

#ifdef __cplusplus
}
#endif
#endif
