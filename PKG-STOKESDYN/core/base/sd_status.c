#include "sd_status.h"

const char *sd_status_string(sd_status status)
{
  switch (status) {
#define SD_STATUS_TEXT(code, text) \
  case code:                       \
    return text;
    SD_STATUS_LIST(SD_STATUS_TEXT)
#undef SD_STATUS_TEXT
  }
  return "unknown status";
}
