#include "sd_mobility.h"

#include <stdlib.h>
#include <string.h>

const sd_mobility_engine *const sd_mobility_engines[] = {
    &sd_mobility_all_pairs,
    &sd_mobility_list,
};
const int sd_mobility_count = sizeof(sd_mobility_engines) / sizeof(sd_mobility_engines[0]);

sd_status sd_mobility_place(sd_mobility *m, const sd_mobility_engine *engine,
                            const sd_mobility_scene *scene)
{
  if (m->engine != engine) {
    sd_mobility_free(m);
    m->state = calloc(1, engine->state);
    if (!m->state) return SD_ENOMEMORY;
    m->engine = engine;
  }
  m->width = scene->how.width;
  m->n = scene->n;
  return engine->place(m->state, scene);
}

sd_status sd_mobility_apply(void *ctx, const double *F, double *u)
{
  const sd_mobility *m = ctx;
  return m->engine->apply(m->state, F, u);
}

void sd_mobility_self(const sd_mobility *m, double *diagonal)
{
  if (m->engine->self)
    m->engine->self(m->state, diagonal);
  else
    memset(diagonal, 0, sizeof(double) * (size_t) m->width * (size_t) m->n);
}

void sd_mobility_free(sd_mobility *m)
{
  if (m->engine) m->engine->free(m->state);
  free(m->state);
  *m = (sd_mobility){0};
}
