#include "sd_mobility.h"

#include <stdlib.h>

sd_status sd_mobility_place(sd_mobility *m, const sd_mobility_engine *engine,
                            const sd_mobility_scene *scene)
{
  if (m->engine != engine) {
    sd_mobility_free(m);
    m->state = calloc(1, engine->state);
    if (!m->state) return SD_ENOMEMORY;
    m->engine = engine;
  }
  return engine->place(m->state, scene);
}

sd_status sd_mobility_apply(void *ctx, const double *F, double *u)
{
  const sd_mobility *m = ctx;
  return m->engine->apply(m->state, F, u);
}

void sd_mobility_free(sd_mobility *m)
{
  if (m->engine) m->engine->free(m->state);
  free(m->state);
  *m = (sd_mobility){0};
}
