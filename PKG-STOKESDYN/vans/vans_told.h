/* What the stream and its fix say once in the life of the fix. */
#ifndef SD_VANS_TOLD_H
#define SD_VANS_TOLD_H

#include "keywords.h"

namespace StokesDyn {

class VansTold {
 public:
  enum What {
    FAR_APART, CUT_OFF, HIGH_BOTTOM, OUTSIDE, WORK, STIFF, WAVES, FALL, ROUGHNESS, SMOOTH, OVERLAP,
    WEIGHT, FULL, SWINGS, LID
  };
  explicit VansTold(const Voice &voice) : voice(voice) {}

  /* For whoever need not look again */
  bool has(What what) const { return said & 1u << what; }
  /* Nothing when it has been said. On all ranks. */
  void warn(What what, const std::string &text)
  {
    if (first(what)) voice.warn(text);
  }
  void tell(What what, const std::string &text)
  {
    if (first(what)) voice.tell(text);
  }

 private:
  const Voice voice;
  unsigned said = 0;

  bool first(What what)
  {
    const bool is = !has(what);
    said |= 1u << what;
    return is;
  }
};

}    // namespace StokesDyn
#endif
