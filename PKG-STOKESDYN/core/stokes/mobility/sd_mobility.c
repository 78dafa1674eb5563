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

int sd_mobility_divides(const sd_mobility *m)
{
  return m->engine && m->engine->divides && m->engine->divides(m->state);
}

sd_status sd_mobility_apply_rest(void *ctx, const double *F, double *u)
{
  const sd_mobility *m = ctx;
  return m->engine->apply_rest(m->state, F, u);
}

sd_status sd_mobility_draw(sd_mobility *m, const sd_random_key *key, double *u)
{
  return m->engine->draw(m->state, key, u);
}

void sd_mobility_free(sd_mobility *m)
{
  if (m->engine) m->engine->free(m->state);
  free(m->state);
  *m = (sd_mobility){0};
}
