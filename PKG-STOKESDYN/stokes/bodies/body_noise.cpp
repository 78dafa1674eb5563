#include "body_noise.h"

namespace StokesDyn {

void BodyNoise::begin(const Epoch &run)
{
  if (!made.first_in(run)) return;
  all_roots.clear();
  all_follow.clear();
}

const sd_body_root *BodyNoise::root(const Voice &voice, const sd_body &body, const sd_ewald *split)
{
  sd_body_root_steps steps = {};
  if (split) steps = sd_body_root_steps_of(body.shape, body.a, split);
  const Which key(body.shape, steps.xi, steps.a_ref, steps.range);
  const auto known = all_roots.find(key);
  if (known != all_roots.end()) return &known->second;
  sd_ewald unit = {};
  if (split) unit = sd_body_root_split(body.shape, &steps, split);
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
