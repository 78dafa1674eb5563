/* make_two_sphere_table > sd_two_sphere_table.inc: the exact functions at the nodes, a minute or two.
 *
 * make_two_sphere_table check STRIDE: the shipped ones at every STRIDE'th node against those
 * computed here and now; fails if they differ. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sd_two_sphere_exact.h"
#include "sd_two_sphere_near.h"
#include "sd_two_sphere_table_internal.h"

enum {
  RATIOS = SD_TWO_SPHERE_RATIOS,
  GAPS = SD_TWO_SPHERE_GAPS,
  FUNCTIONS = SD_TWO_SPHERE_FUNCTIONS
};

/* The inverse of sd_two_sphere_mu */
static double gap_of(double ratio, double mu)
{
  const double s = sinh(0.5 * mu), t = 2.0 * s * s;
  const double q = 8.0 * t * ratio / ((1.0 + ratio) * (1.0 + ratio));
  return q / (2.0 + sqrt(4.0 + q));
}

static void at_node(int i, int j, double value[FUNCTIONS])
{
  const double ratio = pow(SD_TWO_SPHERE_LARGEST_RATIO, sd_two_sphere_node(RATIOS, i));
  const double mu = sd_two_sphere_node(GAPS, j) * sd_two_sphere_largest_mu(ratio);
  const double xi = gap_of(ratio, mu);
  const sd_pair_resistance exact = sd_two_sphere_exact(1.0, ratio, 0.5 * xi * (1.0 + ratio), NULL);
  const sd_pair_resistance near = sd_two_sphere_near(1.0, ratio, xi);
  const sd_pair_resistance alone = sd_two_sphere_alone(1.0, ratio);
  sd_pair_resistance rest = sd_pair_resistance_sum(1.0, &exact, -1.0, &near);
  rest = sd_pair_resistance_sum(1.0, &rest, -1.0, &alone);
  double scale[FUNCTIONS];
  sd_two_sphere_scales(1.0, ratio, scale);
  memcpy(value, &rest, sizeof rest);
  for (int k = 0; k < FUNCTIONS; k++) value[k] /= scale[k];
}

static void make(void)
{
  printf("/* Made by make_two_sphere_table; sd_two_sphere_table_internal.h says of what. */\n");
  for (int i = 0; i < RATIOS; i++) {
    printf("    {\n");
    for (int j = 0; j < GAPS; j++) {
      double value[FUNCTIONS];
      at_node(i, j, value);
      for (int k = 0; k < FUNCTIONS; k++)
        printf("%s%.11f%s",
               k == 0      ? "        {"
                   : k % 4 ? " "
                           : "         ",
               value[k],
               k == FUNCTIONS - 1 ? "},\n"
                   : k % 4 == 3   ? ",\n"
                                  : ",");
    }
    printf("    },\n");
  }
}

static int check(int stride)
{
  double worst = 0.0;
  for (int node = 0; node < RATIOS * GAPS; node += stride) {
    double value[FUNCTIONS];
    at_node(node / GAPS, node % GAPS, value);
    for (int k = 0; k < FUNCTIONS; k++)
      worst = fmax(worst, fabs(value[k] - sd_two_sphere_table[node / GAPS][node % GAPS][k]));
  }
  printf("largest difference %.2g\n", worst);
  return worst < 1e-10 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
  if (argc == 3 && !strcmp(argv[1], "check") && atoi(argv[2]) > 0) return check(atoi(argv[2]));
  if (argc != 1) {
    fprintf(stderr, "usage: make_two_sphere_table [check STRIDE]\n");
    return EXIT_FAILURE;
  }
  make();
  return EXIT_SUCCESS;
}
