/* Random scenes of every kind (random_scene.h): error of a product by Ewald sums, over the tolerance that was asked
 * for. A line for each scene.
 *   bench_tolerance SEED SCENES [MOST [LOOSEST TIGHTEST [KIND [PLACE [SPREAD]]]]]
 * at most 1200 spheres; tolerances as numbers of digits, 1e-2 to 1e-12; all kinds, places and spreads, or `any`, or
 * one that is named in random_scene.h. U: rms error of velocities over the rms of F/(6 pi a); W: of spins over the rms
 * of T/(8 pi a^3), both times a; weights: U under these, of shells that of spheres; flow: rms of velocities under
 * weights over the rms of F/(6 pi a). */
#include "random_scene.h"

static int named(const char *name, const char *const *names, int many)
{
  for (int k = 0; k < many; k++)
    if (!strcmp(name, names[k])) return k;
  return -1;
}

static wish read_wish(int count, char **words)
{
  wish w = {1200, -1, -1, -1, 2, 12};
  if (count > 3) w.most = atoi(words[3]);
  if (count > 5) w.loosest = atof(words[4]), w.tightest = atof(words[5]);
  if (count > 6) w.kind = named(words[6], kinds, KINDS);
  if (count > 7) w.place = named(words[7], places, PLACES);
  if (count > 8) w.spread = named(words[8], spreads, SPREADS);
  return w;
}

static void tell(int number, scene *s)
{
  const errors_over_tolerance e = errors_of(s);
  printf("%4d %-7s %-9s %-8s n %5d w %d ratio %6.2f phi %.4f tol %.1e %s levels %d | ", number, places[s->place],
         kinds[s->kind], spreads[s->spread], s->n, s->width, s->ratio, s->phi, s->tolerance,
         s->floats ? "floats " : "doubles", s->levels);
  printf("U %.3f W %.3f | weights %.3f flow %.3g", e.U, e.W, e.weights, e.flow);
  if (s->kind == SHELLS) printf(" | of spheres %.3f", e.spheres);
  printf("\n");
  fflush(stdout);
}

int main(int count, char **words)
{
  if (count < 3) return 1;
  const int scenes = atoi(words[2]);
  const wish w = read_wish(count, words);
  for (int k = 0; k < scenes; k++) {
    scene s = random_scene(strtoull(words[1], NULL, 10), k, &w);
    tell(k, &s);
    scene_release(&s);
  }
  return 0;
}
