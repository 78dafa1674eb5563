/* Constants of the core. */
#ifndef SD_CONSTANTS_H
#define SD_CONSTANTS_H

#define SD_PI 3.14159265358979323846

#endif
