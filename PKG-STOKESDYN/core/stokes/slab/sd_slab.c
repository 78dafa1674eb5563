#include "sd_slab.h"

#include <math.h>
#include <string.h>

/* All bytes are set, which who compares tables reads. */
static sd_slab_walls walls_of(sd_slab_kind kind, const sd_wall *first)
{
  sd_slab_walls walls;
  memset(&walls, 0, sizeof(walls));
  walls.kind = kind;
  walls.wall[0] = *first;
  return walls;
}

sd_slab_walls sd_slab_layer(int axis)
{
  return walls_of(SD_SLAB_LAYER, &(sd_wall){axis, 1, 0.0});
}

sd_slab_walls sd_slab_floor(const sd_wall *wall)
{
  return walls_of(SD_SLAB_FLOOR, wall);
}

sd_slab_walls sd_slab_slit(int axis, double lo, double hi, int no_flux)
{
  sd_slab_walls walls = walls_of(SD_SLAB_SLIT, &(sd_wall){axis, 1, lo});
  walls.wall[1] = (sd_wall){axis, -1, hi};
  walls.height = hi - lo;
  walls.no_flux = no_flux;
  return walls;
}

void sd_slab_keep_off(const sd_slab_walls *walls, const double x[3], double a, double out[3])
{
  memcpy(out, x, 3 * sizeof(double));
  for (int w = 0; w < sd_slab_many_walls(walls); w++) {
    const double from[3] = {out[0], out[1], out[2]};
    sd_wall_keep_off(walls->wall + w, from, a, out);
  }
}

/* --- the choice --- */

/* Heights for which the present splitting stands, if it is not much too tall for them; else
 * those of the spheres with a twentieth to spare, so that it lasts while they move. Those that
 * cut a floor are kept off it. */
static void room_for(const sd_slab_walls *walls, const sd_slab_spheres *spheres, sd_slab *s)
{
  const double lo = spheres->lo, hi = spheres->hi, smallest = spheres->smallest;
  if (walls->kind == SD_SLAB_SLIT) {
    s->lo = smallest;
    s->hi = walls->height - smallest;
    return;
  }
  const double spare = fmax(0.05 * (hi - lo), spheres->sizes.all.largest);
  const int floor_below = walls->kind == SD_SLAB_FLOOR;
  const double lowest = floor_below ? smallest : lo - spare, highest = hi + spare;
  const int holds = (floor_below ? s->lo == smallest : lo >= s->lo) && hi <= s->hi &&
      s->ewald.count > 0.0 && s->hi - s->lo <= 1.5 * (highest - lowest);
  if (holds) return;
  s->lo = lowest;
  s->hi = fmax(highest, lowest);
}

/* The plane 0 of the grid: below the windows of the lowest spheres, and in a slit such that one
 * table serves both walls. Where the box stands: heights grow with planes, or the other way
 * below a ceiling. */
static void stand(sd_slab *s)
{
  sd_ewald *e = &s->ewald;
  const sd_wall *wall = s->walls.wall;
  const int planes = e->slab.planes;
  s->spacing = e->spacing;
  s->first = s->walls.kind == SD_SLAB_SLIT ? 0.5 * (s->walls.height - (planes - 1) * s->spacing)
                                           : s->lo - (0.5 * e->points + 0.5) * s->spacing;
  const double lowest = wall->sign > 0 ? s->first : s->first + (planes - 1) * s->spacing;
  e->box.origin[wall->axis] = wall->at + wall->sign * lowest;
}

sd_status sd_slab_choose(const sd_slab_walls *walls, const sd_ewald_box *box,
                         const sd_slab_spheres *spheres, double tolerance, sd_slab *out)
{
  sd_slab s;
  memset(&s, 0, sizeof(s)); /* all bytes: the engine compares them */
  s.lo = out->lo;
  s.hi = out->hi;
  s.ewald.count = out->ewald.count;
  memcpy(&s.walls, walls, sizeof(s.walls));
  const int some = spheres->sizes.all.count > 0.0;
  if (some) room_for(walls, spheres, &s);
  const double gap = walls->kind == SD_SLAB_SLIT ? walls->height + 2.0 * spheres->smallest : INFINITY;
  const sd_status status = sd_ewald_choose_in_slab(box, walls->wall->axis, some ? s.hi - s.lo : 0.0,
                                                   gap, &spheres->sizes, tolerance, &s.ewald);
  if (status == SD_OK && s.ewald.count > 0.0) stand(&s);
  memcpy(out, &s, sizeof(s));
  return status;
}

int sd_slab_same_tables(const sd_slab *made, const sd_slab *wanted)
{
  return !memcmp(made, wanted, sizeof(*made));
}

void sd_slab_add_pressure_gradient(const sd_slab_walls *walls, const double edge[3], long n,
                                   const double *x, const double *a, const double *F,
                                   double gradient[3])
{
  const int along[2] = {(walls->wall->axis + 1) % 3, (walls->wall->axis + 2) % 3};
  const double H = walls->height, unit = 6.0 / (edge[along[0]] * edge[along[1]] * H * H * H);
  if (!walls->no_flux) return;
  for (long i = 0; i < n; i++) {
    double at[3];
    sd_slab_keep_off(walls, x + 3 * i, a[i], at);
    const double z = sd_slab_height(walls, at), shape = z * (H - z) - a[i] * a[i] / 3.0;
    for (int d = 0; d < 2; d++) gradient[along[d]] += unit * shape * F[3 * i + along[d]];
  }
}
