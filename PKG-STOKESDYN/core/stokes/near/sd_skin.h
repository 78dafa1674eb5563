/* Lists of who is near whom hold for some time when they are made with a skin: beyond the reach they have those
 * who may get there. As long as nobody stands farther than half a skin from where he stood when a list was made,
 * nobody is missing, whoever they are and whyever they moved: whoever keeps a list also keeps where they stood
 * then, and nobody has to tell him that it is out of date.
 *
 * A part of the reach: with more a list holds longer and has more pairs that are too far apart, (1 + part)^3
 * times as many. */
#ifndef SD_SKIN_H
#define SD_SKIN_H

static inline double sd_with_skin(double reach)
{
  return 1.08 * reach;
}

#endif
