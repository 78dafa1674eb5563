#include "sd_multiblob_half.h"

#include <stddef.h>

/* Made by make_half_shells */
static const sd_multiblob_half halves[] = {
    {42, 0.891248051985625, 0.243548261566292, -3.33161470303e-05, -0.041725825290176,
     -7.2582786822206, 0.022647897222581, -0.041837728417353},
    {162, 0.948914284056629, 0.132586279792341, -1.64655947432e-06, 0.008842943730883,
     -2.4915452620178, 0.0098217806271649, -0.012800888272996},
    {642, 0.976046824853493, 0.0689039777038648, -5.25558664632e-06, 0.015531163511029,
     -0.89726253168972, 0.0028213248887602, -0.0029820627924664},
};

const sd_multiblob_half *sd_multiblob_half_of(int n)
{
  for (size_t k = 0; k < sizeof halves / sizeof *halves; k++)
    if (halves[k].n == n) return halves + k;
  return NULL;
}
