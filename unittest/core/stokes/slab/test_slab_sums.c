/* The engine slab against sums in another code. */
#include "slab.h"

#include "table.h"

enum { MOST = 8 };

/* A scene of slab/scenes.csv */
typedef struct {
  char name[64];
  sd_slab_walls walls;
  double Lx, Ly, x[3 * MOST], a[MOST], F[3 * MOST], U[3 * MOST];
  int n;
} sums;

static sd_slab_walls walls_of(const char *geometry, const char *convention, double H)
{
  const sd_wall ground = {2, 1, 0.0};
  if (!strcmp(geometry, "open")) return sd_slab_layer(2);
  if (!strcmp(geometry, "wall")) return sd_slab_floor(&ground);
  return sd_slab_slit(2, 0.0, H, !strcmp(convention, "flux"));
}

static int read_scenes(sums *all, int most)
{
  int many = 0;
  table t = table_open("slab/scenes.csv");
  while (table_next(&t)) {
    sums *s = all + many - 1;
    if (many == 0 || strcmp(s->name, t.column[0])) {
      assert_true(many < most);
      s = all + many++;
      *s = (sums){.Lx = table_number(&t, 4), .Ly = table_number(&t, 5)};
      strcpy(s->name, t.column[0]);
      s->walls = walls_of(t.column[1], t.column[2], *t.column[3] ? table_number(&t, 3) : 0.0);
    }
    const int i = s->n++;
    s->a[i] = table_number(&t, 10);
    for (int d = 0; d < 3; d++) {
      s->x[3 * i + d] = table_number(&t, 7 + d);
      s->F[3 * i + d] = table_number(&t, 11 + d);
      s->U[3 * i + d] = table_number(&t, 14 + d);
    }
  }
  return many;
}

static void velocities_are_those_of_dense_sums(void **state)
{
  (void) state;
  sums all[MOST];
  const int many = read_scenes(all, MOST);
  assert_int_equal(many, 8);
  for (int k = 0; k < many; k++) {
    const sums *s = all + k;
    const sd_ewald_box box = slab_box(2, s->Lx, s->Ly);
    double u[3 * MOST], largest = 0.0;
    slab_velocities(&s->walls, &box, s->x, s->a, s->n, 1e-12, s->F, u);
    for (int i = 0; i < 3 * s->n; i++) largest = fmax(largest, fabs(s->U[i]));
    for (int i = 0; i < 3 * s->n; i++) {
      if (fabs(u[i] - s->U[i]) < 1e-10 * largest) continue;
      fail_msg("%s, sphere %d: %.15g, not %.15g", s->name, i / 3, u[i], s->U[i]);
    }
  }
}

/* Across a floor in a cell of 76.8 radii, over 1/(6 pi a): lattice sums of other authors with 200 images each way
 * (repository DoublyPeriodicStokes, self_mobility_bw_ref). Along it their lattice ends too early: 3e-7 to 3e-5 off. */
static void a_lone_sphere_above_a_floor_is_that_of_dpstokes(void **state)
{
  (void) state;
  static const double height[] = {1.0, 97.0 / 59.0, 9.6}, across[] = {0.24999995, 0.41782986, 0.88318621};
  static const double along[] = {0.50008938, 0.6810276, 0.94935265}, off[] = {5e-7, 1e-6, 3e-5};
  const sd_wall ground = {2, 1, 0.0};
  const sd_slab_walls walls = sd_slab_floor(&ground);
  const sd_ewald_box box = slab_box(2, 76.8, 76.8);
  for (int k = 0; k < 3; k++) {
    const double x[3] = {0.1, 0.2, height[k]}, a = 1.0, F[3] = {6.0 * SD_PI, 0.0, 6.0 * SD_PI};
    double u[3];
    slab_velocities(&walls, &box, x, &a, 1, 1e-10, F, u);
    CHECK_NEAR(u[2], across[k], 1e-8);
    CHECK_NEAR(u[0], along[k], off[k]);
  }
}

static int sums_asked;

static sd_status count_sums(void *ctx, double *values, int count)
{
  (void) ctx, (void) values, (void) count;
  sums_asked++;
  return SD_OK;
}

/* All that a product needs of all ranks goes by one message. */
static void a_product_asks_ranks_for_one_sum(void **state)
{
  (void) state;
  const sd_wall ground = {2, 1, 0.0};
  const sd_slab_walls walls = sd_slab_floor(&ground);
  const sd_ewald_box box = slab_box(2, 30.0, 25.0);
  const double x[6] = {0.1, 0.2, 2.3, 4.0, 1.5, 6.1}, a[2] = {0.7, 1.4}, F[6] = {1.3, -0.4, 0.6, 0.2, 0.9, -1.1};
  double u[6], alone[6];
  slab s;
  slab_place(&s, &walls, &box, x, a, 2, 1e-4);
  assert_int_equal(sd_mobility_apply(&s.omega, F, alone), SD_OK);
  const sd_mobility_scene asking = {.how = {.law = {.tensor = SD_TENSOR_RPY}, .width = 3, .slab = &s.slab},
                                    .n = 2, .n_all = s.n_all, .spheres = {s.x, s.a, s.w},
                                    .world = {.ctx = &s, .refresh = slab_refresh, .sum = count_sums}};
  assert_int_equal(sd_mobility_place(&s.omega, &sd_mobility_slab, &asking), SD_OK);
  sums_asked = 0;
  assert_int_equal(sd_mobility_apply(&s.omega, F, u), SD_OK);
  assert_int_equal(sums_asked, 1);
  for (int i = 0; i < 6; i++) CHECK_NEAR(u[i], alone[i], 0.0);
  slab_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(velocities_are_those_of_dense_sums),
      cmocka_unit_test(a_lone_sphere_above_a_floor_is_that_of_dpstokes),
      cmocka_unit_test(a_product_asks_ranks_for_one_sum),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
