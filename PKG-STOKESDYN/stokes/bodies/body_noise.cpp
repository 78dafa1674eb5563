#include "body_noise.h"

#include <algorithm>
#include <cmath>

namespace StokesDyn {

static const double STEP = 0.03;

void BodyNoise::begin(const Epoch &run)
{
  if (!made.first_in(run)) return;
  all_roots.clear();
  all_follow.clear();
}

/* A length of the shape, in its own unit: that of a clump is the unit of length of the run, on which nothing
 * may depend */
static double length_of(const sd_body_shape &shape)
{
  return *std::max_element(shape.radius, shape.radius + shape.m);
}

/* The splitting over that length, in steps */
struct Steps {
  int of_xi, of_ref;
};

static Steps steps_of(const sd_ewald &split, double length)
{
  const auto steps = [](double part) { return (int) lround(log(part) / STEP); };
  return {steps(split.xi * length), steps(split.a_ref / length)};
}

/* That splitting, in the unit of the shape */
static sd_ewald in_unit_of_shape(const sd_ewald &split, const Steps &steps, double length)
{
  sd_ewald unit = split;
  unit.xi = exp(STEP * steps.of_xi) / length;
  unit.band = split.band * unit.xi / split.xi;
  unit.range = split.range * split.xi / unit.xi;
  unit.a_ref = exp(STEP * steps.of_ref) * length;
  return unit;
}

const sd_body_root *BodyNoise::root(const Voice &voice, const sd_body &body, const sd_ewald *split)
{
  const double length = length_of(*body.shape);
  const Steps steps = split ? steps_of(*split, body.a * length) : Steps{0, 0};
  const auto key = std::make_tuple(body.shape, steps.of_xi, steps.of_ref);
  const auto known = all_roots.find(key);
  if (known != all_roots.end()) return &known->second;
  sd_ewald unit = {};
  if (split) unit = in_unit_of_shape(*split, steps, length);
  auto &made_now = all_roots[key];
  const sd_status status = sd_body_root_create(body.shape, 1.0, split ? &unit : nullptr, &made_now);
  if (status != SD_OK) voice.of("keyword temperature: roots of bodies").fail_one(sd_status_string(status));
  return &made_now;
}

std::vector<const sd_body_root *> BodyNoise::roots(const Voice &voice, const std::vector<sd_body> &bodies,
                                                   const sd_ewald *split)
{
  std::vector<const sd_body_root *> out(bodies.size() + 1, nullptr);
  for (size_t b = 0; b < bodies.size(); b++)
    if (bodies[b].shape) out[b] = root(voice, bodies[b], split);
  return out;
}

const sd_body_follow *BodyNoise::follow(const Voice &voice, const sd_body &body)
{
  if (!body.shape) return nullptr;
  const auto known = all_follow.find(body.shape);
  if (known != all_follow.end()) return &known->second;
  auto &made_now = all_follow[body.shape];
  const sd_status status = sd_body_follow_create(body.shape, &made_now);
  if (status != SD_OK) voice.of("keyword temperature: bodies").fail_one(sd_status_string(status));
  return &made_now;
}

}    // namespace StokesDyn
