/* A list of who is near whom holds for some time if it is made with a skin: it has the pairs within the
 * reach, and those a little farther apart, which may come within it. As long as no sphere stands farther than
 * half the skin from where it stood when the list was made, no pair is missing, whatever has moved them.
 * Who keeps a list keeps these places too, and compares: nobody has to tell him that the list is out of
 * date.
 *
 * The skin is a part of the reach. With more of it a list holds longer and has more pairs that are too far
 * apart, (1 + part)^3 times as many. */
#ifndef SD_SKIN_H
#define SD_SKIN_H

static inline double sd_with_skin(double reach)
{
  return 1.08 * reach;
}

#endif
