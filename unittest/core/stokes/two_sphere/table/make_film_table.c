/* make_film_table > sd_film_table.inc: the mean resistance of two shells of points, all spheres alike, at
 * the nodes of sd_film_table_internal.h; some minutes. make_film_table half > sd_film_half_table.inc: the
 * same of shells by radius; 25 minutes.
 *
 * make_film_table check KIND RATIO GAP: the shipped numbers of one node against those computed here
 * and now; check half KIND T Q: those by radius between the nodes, at T and Q in 0 to 1 of the ranges of
 * ratio and gap; fails if they differ. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sd_shell_pair.h"
#include "sd_two_sphere_table_internal.h"

enum { RATIOS = SD_FILM_RATIOS, GAPS = SD_FILM_GAPS, SCALARS = SD_FILM_SCALARS };

static double ratio_of_v(double v)
{
  return (1.0 + v) / (1.0 - v);
}

/* --- the tables --- */

/* Two shells and how they stand */
typedef struct {
  sd_shell_blob one, two;
  sd_shell_pair *both;
  int count;
  sd_shell_way *ways;
} mean;

static void begin(mean *m, int count)
{
  m->both = sd_shell_pair_create(&m->one, &m->two);
  m->count = count;
  m->ways = malloc(sizeof(sd_shell_way) * (size_t) count);
  if (!m->ways) exit(EXIT_FAILURE);
}

/* Of spheres that are all alike: those of 42 points differ less, and cost more. */
static void begin_alike(mean *m, int n)
{
  m->one = sd_shell_blob_alike(n);
  m->two = sd_shell_blob_alike(n);
  begin(m, n == 12 ? 2048 : 1024);
  sd_shell_ways(m->count, m->ways);
}

/* The more points, the less do orientations differ, and the more does each cost. */
static void begin_kind(mean *m, const sd_film_kind *kind)
{
  static const int counts[SD_FILM_HALF_KINDS] = {512, 512, 128, 512, 512, 64, 64, 16, 8};
  m->one = sd_shell_blob_by_radius(kind->small);
  m->two = sd_shell_blob_by_radius(kind->large);
  begin(m, counts[kind - sd_film_kinds]);
  sd_shell_ways_of_icosahedra(m->count, m->ways);
}

static void end(mean *m)
{
  sd_shell_pair_free(m->both);
  free(m->one.r);
  free(m->two.r);
  free(m->ways);
}

static void alike_at(mean *m, int i, int j, double value[2][SCALARS])
{
  const double ratio = ratio_of_v(SD_FILM_LARGEST_V * sd_two_sphere_node(RATIOS, i));
  const double q = sd_two_sphere_node(GAPS, j);
  sd_shell_pair_means(m->both, ratio, SD_FILM_LARGEST_XI * q * q, m->count, m->ways, value);
}

/* At t of the nodes of the kind's ratio and q of those of the gap */
static void by_radius_at(mean *m, const sd_film_kind *kind, double t, double q, double value[2][SCALARS])
{
  const double low = sd_film_v(kind->lowest), v = low + (sd_film_v(kind->highest) - low) * t;
  const double xi = SD_FILM_LARGEST_XI * q * q * (1.0 - v * v);
  sd_shell_pair_means(m->both, ratio_of_v(v), xi, m->count, m->ways, value);
}

static void print_rows(double value[GAPS][2][SCALARS], int with, int digits, const char *indent)
{
  for (int j = 0; j < GAPS; j++) {
    printf("%s{", indent);
    for (int k = 0; k < SCALARS; k++) printf("%s%.*f", k ? ", " : "", digits, value[j][with][k]);
    printf("},\n");
  }
}

/* The kinds of sd_film_table: of each number of points without the addition, and with it */
static void make_alike(void)
{
  printf("/* Made by make_film_table; sd_film_table_internal.h says of what. */\n");
  for (int kind = 0; kind < SD_FILM_KINDS; kind++) {
    mean m;
    begin_alike(&m, kind < 2 ? 12 : 42);
    printf("    {\n");
    for (int i = 0; i < RATIOS; i++) {
      double value[GAPS][2][SCALARS];
      for (int j = 0; j < GAPS; j++) alike_at(&m, i, j, value[j]);
      printf("        {\n");
      print_rows(value, kind % 2, 9, "            ");
      printf("        },\n");
      fflush(stdout);
    }
    printf("    },\n");
    end(&m);
  }
}

static void make_kind(const sd_film_kind *kind)
{
  mean m;
  begin_kind(&m, kind);
  printf("/* %d with %d */\n", kind->large, kind->small);
  for (int i = 0; i < kind->ratios; i++) {
    double value[GAPS][2][SCALARS];
    for (int j = 0; j < GAPS; j++)
      by_radius_at(&m, kind, sd_two_sphere_node(kind->ratios, i), sd_two_sphere_node(GAPS, j), value[j]);
    for (int with = 0; with < 2; with++) {
      printf("%s", with ? "{\n" : "{{\n");
      print_rows(value, with, 5, "");
      printf("%s", with ? "}},\n" : "},\n");
    }
    fflush(stdout);
  }
  end(&m);
}

static void make_half(void)
{
  printf("/* Made by make_film_table half; sd_film_table_internal.h says of what. */\n");
  for (int k = 0; k < SD_FILM_HALF_KINDS; k++) make_kind(sd_film_kinds + k);
}

/* --- checks --- */

static int say(double worst, double most)
{
  printf("largest difference %.2g\n", worst);
  return worst < most ? EXIT_SUCCESS : EXIT_FAILURE;
}

static int check_alike(int kind, int i, int j)
{
  double value[2][SCALARS], worst = 0.0;
  mean m;
  begin_alike(&m, kind < 2 ? 12 : 42);
  alike_at(&m, i, j, value);
  end(&m);
  for (int k = 0; k < SCALARS; k++)
    worst = fmax(worst, fabs(value[kind % 2][k] - sd_film_table[kind][i][j][k]));
  return say(worst, 1e-8);
}

/* The means at t of the nodes of a kind's ratio and q of those of the gap, from its nodes */
static void between_nodes(int kind, double t, double q, int with, double out[SCALARS])
{
  int row = 0;
  double w[RATIOS], g[GAPS];
  for (int k = 0; k < kind; k++) row += sd_film_kinds[k].ratios;
  sd_two_sphere_weights(sd_film_kinds[kind].ratios, t, w);
  sd_two_sphere_weights(GAPS, q, g);
  memset(out, 0, sizeof(double) * SCALARS);
  for (int i = 0; i < sd_film_kinds[kind].ratios; i++)
    for (int j = 0; j < GAPS; j++)
      for (int k = 0; k < SCALARS; k++)
        out[k] += w[i] * g[j] * sd_film_half_table[row + i][with][j][k];
}

/* Between the nodes as well: to 2e-3 of the approach */
static int check_half(int number, double t, double q)
{
  const sd_film_kind *kind = sd_film_kinds + number;
  double value[2][SCALARS], worst = 0.0;
  mean m;
  begin_kind(&m, kind);
  by_radius_at(&m, kind, t, q, value);
  end(&m);
  for (int with = 0; with < 2; with++) {
    double shipped[SCALARS];
    between_nodes(number, t, q, with, shipped);
    for (int k = 0; k < SCALARS; k++)
      worst = fmax(worst, fabs(value[with][k] - shipped[k]) / value[with][0]);
  }
  return say(worst, 2e-3);
}

static int usage(void)
{
  fprintf(stderr, "usage: make_film_table [half | check KIND RATIO GAP | check half KIND T Q]\n");
  return EXIT_FAILURE;
}

int main(int argc, char **argv)
{
  const int checks = argc > 1 && !strcmp(argv[1], "check");
  if (checks && argc == 5) return check_alike(atoi(argv[2]), atoi(argv[3]), atoi(argv[4]));
  if (checks && argc == 6) return check_half(atoi(argv[3]), atof(argv[4]), atof(argv[5]));
  if (argc == 1)
    make_alike();
  else if (argc == 2 && !strcmp(argv[1], "half"))
    make_half();
  else
    return usage();
  return EXIT_SUCCESS;
}
