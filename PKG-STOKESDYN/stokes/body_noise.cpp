#include "body_noise.h"

#include <cmath>

namespace StokesDyn {

static const double STEP = 0.03;

void BodyNoise::begin(const Epoch &run)
{
  if (!made.first_in(run)) return;
  all_roots.clear();
  all_follow.clear();
}

/* The splitting of bodies of radius 1 that this is for one of radius a, to the step */
static sd_ewald of_unit_body(const sd_ewald &split, int of_xi, int of_ref)
{
  sd_ewald unit = split;
  const double xi = exp(STEP * of_xi), lengths = split.xi / xi;
  unit.xi = xi;
  unit.band = split.band * xi / split.xi;
  unit.range = split.range * lengths;
  unit.a_ref = exp(STEP * of_ref);
  return unit;
}

std::vector<const sd_body_root *> BodyNoise::roots(const Voice &voice, const std::vector<sd_body> &bodies,
                                                   const sd_ewald *split)
{
  std::vector<const sd_body_root *> out(bodies.size() + 1, nullptr);
  for (size_t b = 0; b < bodies.size(); b++) {
    const sd_body &body = bodies[b];
    if (!body.shape) continue;
    const auto steps = [](double part) { return (int) lround(log(part) / STEP); };
    const int of_xi = split ? steps(split->xi * body.a) : 0, of_ref = split ? steps(split->a_ref / body.a) : 0;
    const auto key = std::make_tuple(body.shape, split ? of_xi : 0, split ? of_ref : 0);
    const auto known = all_roots.find(key);
    if (known != all_roots.end()) {
      out[b] = &known->second;
      continue;
    }
    sd_ewald unit = {};
    if (split) unit = of_unit_body(*split, of_xi, of_ref);
    auto &root = all_roots[key];
    const sd_status status = sd_body_root_create(body.shape, 1.0, split ? &unit : nullptr, &root);
    if (status != SD_OK) voice.of("keyword temperature: roots of bodies").fail_one(sd_status_string(status));
    out[b] = &root;
  }
  return out;
}

const sd_body_follow *BodyNoise::follow(const Voice &voice, const sd_body &body, Turns turns)
{
  if (!body.shape) return nullptr;
  const auto known = all_follow.find(body.shape);
  if (known != all_follow.end()) return &known->second;
  auto &made_now = all_follow[body.shape];
  const sd_status status = turns == STILL ? sd_body_follow_mean(body.shape, &made_now)
                                          : sd_body_follow_create(body.shape, turns == ALONG, &made_now);
  if (status != SD_OK) voice.of("keyword temperature: bodies").fail_one(sd_status_string(status));
  return &made_now;
}

}    // namespace StokesDyn
