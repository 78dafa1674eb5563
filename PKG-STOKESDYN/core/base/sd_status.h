/* Status codes of the core, with their texts in one list. The glue puts command, numbers and the
 * way out around them. */
#ifndef SD_STATUS_H
#define SD_STATUS_H

#include "sd_extern_c.h"

SD_BEGIN_C

#define SD_STATUS_LIST(_)                                                              \
  _(SD_OK, "converged")                                                                \
  _(SD_EMAXITER, "no convergence within the allowed iterations")                       \
  _(SD_ESTAGNATED, "stopped at the accuracy of double precision, above the tolerance") \
  _(SD_EDIVERGED, "diverged")                                                          \
  _(SD_EINDEFINITE, "the mobility matrix is not positive definite")                    \
  _(SD_ESINGULAR, "the mobility matrix is singular")                                   \
  _(SD_ENOTFINITE, "met a value that is not a finite number")                          \
  _(SD_ENOMEMORY, "out of memory")                                                     \
  _(SD_EOUTSIDE, "outside of the given data")                                          \
  _(SD_ECALLBACK, "a function of the calling program has failed")

typedef enum {
#define SD_STATUS_CODE(code, text) code,
  SD_STATUS_LIST(SD_STATUS_CODE)
#undef SD_STATUS_CODE
} sd_status;

const char *sd_status_string(sd_status status);

SD_END_C
#endif
