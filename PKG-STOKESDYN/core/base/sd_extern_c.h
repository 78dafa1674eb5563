/* What C++ includes as well stands between SD_BEGIN_C and SD_END_C. */
#ifndef SD_EXTERN_C_H
#define SD_EXTERN_C_H

#ifdef __cplusplus
#define SD_BEGIN_C extern "C" {
#define SD_END_C }
#else
#define SD_BEGIN_C
#define SD_END_C
#endif

#endif
