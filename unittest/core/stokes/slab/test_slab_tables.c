/* One sphere in a cell, in the engine slab, against tables of another code and of other authors. */
#include "slab.h"

#include "table.h"

static double number_or(const table *t, int column, double none)
{
  return *t->column[column] ? table_number(t, column) : none;
}

static sd_slab_walls walls_at(const char *geometry, double H, int no_flux)
{
  const sd_wall ground = {2, 1, 0.0};
  return strcmp(geometry, "slit") ? sd_slab_floor(&ground) : sd_slab_slit(2, 0.0, H, no_flux);
}

/* Along x and across, over the velocity of the sphere alone in free fluid */
static void velocities(const char *geometry, double H, int no_flux, double z, double L, double tolerance, double *along,
                       double *across)
{
  const sd_slab_walls walls = walls_at(geometry, H, no_flux);
  const sd_ewald_box box = slab_box(2, L, L);
  const double x[3] = {0.37 * L, 0.21 * L, z}, a = 1.0, F[3] = {6.0 * SD_PI, 0.0, 6.0 * SD_PI};
  double u[3];
  slab_velocities(&walls, &box, x, &a, 1, tolerance, F, u);
  *along = u[0];
  *across = u[2];
}

/* Lines of a table with a geometry, H and heights; `L`, along, across and along without flux in these columns */
static int check_table(const char *name, int z, int L, int along, int across, int flux, double off)
{
  table t = table_open(name);
  int many = 0;
  while (table_next(&t)) {
    const char *geometry = t.column[0];
    if (!strcmp(geometry, "open")) continue;
    const double H = number_or(&t, z == 2 ? 1 : 2, 0.0);
    double u[3], w;
    velocities(geometry, H, 0, table_number(&t, z), table_number(&t, L), 1e-8, u, u + 1);
    velocities(geometry, H, 1, table_number(&t, z), table_number(&t, L), 1e-8, u + 2, &w);
    CHECK_NEAR(u[0], table_number(&t, along), off * fmax(1.0, u[0]));
    CHECK_NEAR(u[1], table_number(&t, across), off);
    if (!strcmp(geometry, "slit")) CHECK_NEAR(u[2], table_number(&t, flux), off * fmax(1.0, u[0]));
    many++;
  }
  return many;
}

static void a_lone_sphere_moves_as_the_cell_says(void **state)
{
  (void) state;
  assert_true(check_table("slab/self_against_L.csv", 2, 3, 4, 5, 6, 1e-7) > 70);
}

static void layers_move_as_their_area_fraction_says(void **state)
{
  (void) state;
  assert_true(check_table("slab/monolayer.csv", 2, 4, 5, 6, 7, 1e-6) >= 20);
}

/* In our own sums all digits; of DPStokes those that its lattice and its kernel leave: along a floor the lattice ends
 * at 200 cells, which misses 3 g h/(2 S r_c) in units of F/eta, r_c near 200 L; in a slit the kernel of a sphere is
 * another one, 6e-4 off in the bulk and more the closer to contact. */
static void a_lone_sphere_is_that_of_dpstokes(void **state)
{
  (void) state;
  assert_true(check_table("slab/dpstokes_self.csv", 3, 1, 4, 5, 6, 1e-7) >= 12);
  table t = table_open("slab/dpstokes_self.csv");
  while (table_next(&t)) {
    const int slit = !strcmp(t.column[0], "slit");
    const double z = table_number(&t, 3), L = table_number(&t, 1);
    double along, across;
    velocities(t.column[0], number_or(&t, 2, 0.0), 0, z, L, 1e-8, &along, &across);
    if (slit && z < 2.5) continue;
    CHECK_NEAR(along, table_number(&t, 7), slit ? 1.2e-3 : 1e-7 + 3e-7 * z * z);
    CHECK_NEAR(across, table_number(&t, 8), slit ? 1.4e-3 : 1e-8);
  }
}

/* The mean of the velocities with and without flux is that in a slit without end, but for quadrupoles: the dipole of
 * the long waves is taken away. RPY_parallel, RPY_normal of another code by quadrature;
 * Faxen's series, of a sphere in the middle, is good to 4e-4 at a slit of ten radii and better in wider ones. */
static void a_sphere_in_the_middle_moves_as_faxen_says(void **state)
{
  (void) state;
  static const double rows[][4] = {{4, 0.54489764, 0.36615885, 0.0}, {6, 0.68007668, 0.54452248, 0.0},
                                   {10, 0.80246530, 0.71594178, 0.802826},
                                   {20, 0.90000416, 0.85563173, 0.900037}, {50, 0.95986189, 0.94198786, 0.959867}};
  for (int k = 0; k < 5; k++) {
    const double H = rows[k][0], s = 2.0 / H, L = 6.0 * H;
    const double faxen = 1.0 - 1.004 * s + 0.418 * pow(s, 3) + 0.21 * pow(s, 4) - 0.169 * pow(s, 5);
    double with, without, across;
    velocities("slit", H, 0, 0.5 * H, L, 1e-8, &with, &across);
    velocities("slit", H, 1, 0.5 * H, L, 1e-8, &without, &across);
    CHECK_NEAR(0.5 * (with + without), rows[k][1], 1e-5);
    CHECK_NEAR(across, rows[k][2], 1e-5);
    if (rows[k][3] == 0.0) continue;
    CHECK_NEAR(faxen, rows[k][3], 1e-6);
    CHECK_NEAR(0.5 * (with + without), faxen, H < 15 ? 4e-4 : 4e-5);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_lone_sphere_moves_as_the_cell_says),
      cmocka_unit_test(layers_move_as_their_area_fraction_says),
      cmocka_unit_test(a_lone_sphere_is_that_of_dpstokes),
      cmocka_unit_test(a_sphere_in_the_middle_moves_as_faxen_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
