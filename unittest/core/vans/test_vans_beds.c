/* Laws of drag that have the neighbours of a grain in them, beside the formulas as they are published. */
#include "check.h"

#include "sd_constants.h"
#include "sd_vans.h"

static const double RHO = 970.0, ETA = 1.7e-3, A = 0.8e-3;

static double force(sd_drag_of_one law, double e, double w)
{
  const sd_drag_law kind = {.law = law, .hindrance = SD_HINDRANCE_OWN};
  return sd_drag_factor(kind, RHO, ETA, A, e, w) * w;
}

/* The pressure drop per length of a fixed bed that is passed at the superficial velocity V, from the
 * published form of a law: Ergun's own; the others by beta (w - v), the force per volume without the part
 * of this pressure on the grains, which takes e of the drop. */
static double published(sd_drag_of_one law, double e, double V)
{
  const double phi = 1.0 - e, d = 2.0 * A, w = V / e, Re = RHO * V * d / ETA;
  const double of_ergun =
      150.0 * phi * phi * ETA * V / (e * e * e * d * d) + 1.75 * phi * RHO * V * V / (e * e * e * d);
  switch (law) {
    case SD_DRAG_ERGUN: return of_ergun;
    case SD_DRAG_GIDASPOW: {
      if (e <= 0.8) return of_ergun;
      const double C_d = Re < 989.0 ? 24.0 / Re * (1.0 + 0.15 * pow(Re, 0.687)) : 0.44,
                   beta = 0.75 * C_d * e * phi * RHO * w / d * pow(e, -2.65);
      return beta * w / e;
    }
    case SD_DRAG_BEETSTRA: {
      const double F = 10.0 * phi / pow(e, 2.0) + pow(e, 2.0) * (1.0 + 1.5 * sqrt(phi)) +
          0.413 * Re / (24.0 * pow(e, 2.0)) * (1.0 / e + 3.0 * e * phi + 8.4 * pow(Re, -0.343)) /
              (1.0 + pow(10.0, 3.0 * phi) / pow(Re, (1.0 + 4.0 * phi) / 2.0)),
                   beta = 18.0 * ETA * e * phi / (d * d) * F;
      return beta * w / e;
    }
    default: {
      const double F_0 = phi < 0.4 ? (1.0 + 3.0 * sqrt(phi / 2.0) + 135.0 / 64.0 * phi * log(phi) + 16.14 * phi) /
              (1.0 + 0.681 * phi - 8.48 * phi * phi + 8.16 * phi * phi * phi)
                                     : 10.0 * phi / pow(e, 3.0),
                   F_3 = 0.0673 + 0.212 * phi + 0.0232 / pow(e, 5.0),
                   beta = 18.0 * ETA * e * e * phi / (d * d) * (F_0 + 0.5 * F_3 * Re);
      return beta * w / e;
    }
  }
}

/* In a fixed bed the drag of the grains, phi/volume of them, is the whole pressure drop. */
static void a_fixed_bed_has_the_published_pressure_drop(void **state)
{
  (void) state;
  const double volume = 4.0 / 3.0 * SD_PI * A * A * A;
  for (int law = SD_DRAG_ERGUN; law <= SD_DRAG_KOCH_HILL; law++)
    for (double phi = 0.05; phi < 0.66; phi += 0.0713)
      for (double Re = 0.01; Re < 2000.0; Re *= 7.3) {
        const double e = 1.0 - phi, V = Re * ETA / (RHO * 2.0 * A),
                     drop = phi / volume * force((sd_drag_of_one) law, e, V / e);
        CHECK_NEAR(drop / published((sd_drag_of_one) law, e, V), 1.0, 1e-12);
      }
}

/* Stokes' drag alone in slow water; Ergun's law has no lone grain. */
static void lone_grains_have_stokes_drag(void **state)
{
  (void) state;
  const double w = 1e-12, stokes = 6.0 * SD_PI * A * ETA * w;
  for (int law = SD_DRAG_GIDASPOW; law <= SD_DRAG_KOCH_HILL; law++)
    CHECK_NEAR(force((sd_drag_of_one) law, 1.0, w) / stokes, 1.0, 1e-6);
  assert_true(force(SD_DRAG_ERGUN, 1.0, w) < 1e-6 * stokes);
}

/* Faster water pulls more, and so does water between more grains: but where a law changes its formula. */
static void drag_grows_with_speed_and_with_phi(void **state)
{
  (void) state;
  for (int law = SD_DRAG_ERGUN; law <= SD_DRAG_KOCH_HILL; law++)
    for (double phi = 0.01; phi < 0.65; phi += 0.02)
      for (double w = 1e-5; w < 3.0; w *= 2.0) {
        const sd_drag_of_one kind = (sd_drag_of_one) law;
        assert_true(force(kind, 1.0 - phi, 1.1 * w) > 1.1 * force(kind, 1.0 - phi, w) * (1.0 - 1e-12));
        const int corner = fabs(phi - 0.2) < 0.021 || fabs(phi - 0.4) < 0.021;
        assert_true(corner || force(kind, 1.0 - phi - 0.02, w) > force(kind, 1.0 - phi, w));
      }
}

/* The table of doc/vans_forces.md: pressure drop of a fixed bed of phi 0.6 over Ergun's, and settling speeds
 * at phi 0.1 to 0.5 over that of a lone slow grain. */
static void the_page_has_these_tables(void **state)
{
  (void) state;
  static const struct {
    const char *name;
    sd_drag_law law;
    double drop[5], settling[5];
  } rows[] = {
      {"gidaspow",
       {SD_DRAG_GIDASPOW, SD_HINDRANCE_OWN, 0},
       {1.00, 1.00, 1.00, 1.00, 1.00},
       {0.61, 0.31, 0.14, 0.065, 0.030}},
      {"beetstra",
       {SD_DRAG_BEETSTRA, SD_HINDRANCE_OWN, 0},
       {1.21, 1.19, 1.10, 0.98, 0.73},
       {0.37, 0.19, 0.10, 0.051, 0.024}},
      {"koch_hill",
       {SD_DRAG_KOCH_HILL, SD_HINDRANCE_OWN, 0},
       {1.20, 1.19, 1.14, 0.94, 0.83},
       {0.35, 0.19, 0.11, 0.054, 0.025}},
      {"brown_lawler, di_felice",
       {SD_DRAG_BROWN_LAWLER, SD_HINDRANCE_DI_FELICE, 0},
       {0.95, 0.88, 0.81, 0.85, 0.74},
       {0.61, 0.35, 0.19, 0.091, 0.038}},
      {"brown_lawler, richardson_zaki",
       {SD_DRAG_BROWN_LAWLER, SD_HINDRANCE_RICHARDSON_ZAKI, 0},
       {0.61, 0.54, 0.65, 0.69, 0.85},
       {0.61, 0.35, 0.19, 0.093, 0.040}},
      {"yade, hindrance 3.1",
       {SD_DRAG_YADE, SD_HINDRANCE_POWER, 0},
       {0.56, 0.57, 0.68, 1.04, 1.26},
       {0.64, 0.39, 0.23, 0.121, 0.057}},
  };
  const double Re[] = {0.1, 1.0, 10.0, 100.0, 1000.0}, phi[] = {0.1, 0.2, 0.3, 0.4, 0.5};
  for (size_t k = 0; k < sizeof(rows) / sizeof(*rows); k++) {
    printf("    %-30s", rows[k].name);
    for (int m = 0; m < 5; m++) {
      const double V = Re[m] * ETA / (RHO * 2.0 * A), w = V / 0.4, bed = 0.6;
      double h;
      sd_hindrance_of(rows[k].law, 1, &bed, 3.1, &h);
      const double drop = sd_drag_factor(rows[k].law, RHO, ETA, A, h, w) * w / force(SD_DRAG_ERGUN, 0.4, w);
      printf(" %.2f", drop);
      CHECK_NEAR(drop, rows[k].drop[m], 0.006);
    }
    printf("  settling");
    for (int m = 0; m < 5; m++) {
      const double w = 1e-9;
      double h;
      sd_hindrance_of(rows[k].law, 1, phi + m, 3.1, &h);
      const double speed =
          (1.0 - phi[m]) * 6.0 * SD_PI * A * ETA / sd_drag_factor(rows[k].law, RHO, ETA, A, h, w);
      printf(" %.3f", speed);
      CHECK_NEAR(speed, rows[k].settling[m], 0.006);
    }
    printf("\n");
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_fixed_bed_has_the_published_pressure_drop),
      cmocka_unit_test(lone_grains_have_stokes_drag),
      cmocka_unit_test(drag_grows_with_speed_and_with_phi),
      cmocka_unit_test(the_page_has_these_tables),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
