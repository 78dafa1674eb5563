#include "shells.h"

#include "copy.h"
#include "keywords.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Shells of larger spheres, and radii over the smallest from which on they are needed */
static const struct {
  int points;
  double from;
} LARGER[] = {{42, 1.5}, {162, 2.5}, {642, 5.0}};
static const double LARGEST = 10.0;

/* A ratio that is just a bound is not above it. */
static bool above(double ratio, double bound)
{
  return ratio > bound * (1.0 + 1e-9);
}

void Shells::make()
{
  models.clear();
  classes = Classes();
  chosen.never();
  if (settings.on()) choose(0.0, 0.0, Epoch());
}

void Shells::add_model(int n, bool half)
{
  models.emplace_back();
  lone.emplace_back(new Owned<sd_multiblob_shape, sd_multiblob_shape_free>());
  swimmers.emplace_back();
  sd_multiblob &model = models.back();
  sd_multiblob_shape &shape = *lone.back();
  sd_status status = half ? sd_multiblob_create_half(n, settings.one_body, &model)
                          : sd_multiblob_create(n, settings.one_body, &model);
  if (status == SD_OK) status = sd_multiblob_shape_create(&model, nullptr, nullptr, &shape);
  if (status != SD_OK) fail_by(voice.of("keyword multiblob: '" + std::to_string(n) + "'"), status);
  sd_squirmer_create(&model, &shape.points, &swimmers.back());
  patterns.push_back({model.n, shape.faces});
}

/* The table of the page on multiblobs has the errors. */
void Shells::warn_of_alike(double largest) const
{
  voice.warn("keyword multiblob_most: radii from " + text(classes.smallest) + " to " + text(largest) +
             ": all spheres have " + std::to_string(settings.points) +
             " points, and small spheres feel those of a large one beside them: velocities are wrong by "
             "up to 2 % at a ratio of 2, 5 % at 10, spins by up to 25 %");
}

/* In a run spheres keep their points, though smaller ones may come and radii may change. */
void Shells::warn_of_newcomers(double smallest, double largest, const Epoch &run)
{
  if (settings.alike() || !above(unlike() ? classes.smallest : largest, LARGER[0].from * smallest) ||
      !outgrown.first_in(run))
    return;
  voice.warn("keyword multiblob: radii have come to be from " + text(smallest) + " to " + text(largest) +
             " since the run began: larger spheres get more points when the next run begins, and until then "
             "small ones feel the few points of a large one beside them: begin another run");
}

bool Shells::choose(double smallest, double largest, const Epoch &run)
{
  const bool first = chosen.first_in(run) || models.empty();
  const Classes before = classes;
  if (first && smallest > 0.0) {
    if (classes.smallest == 0.0 || smallest < classes.smallest ||
        above(largest, LARGEST * classes.smallest))
      classes.smallest = smallest;
    if (above(largest, LARGER[0].from * classes.smallest)) {
      if (settings.alike()) warn_of_alike(largest);
      classes.unlike = !settings.alike();
    }
  } else if (smallest > 0.0) {
    warn_of_newcomers(smallest, largest, run);
  }
  if (unlike() && settings.most == 642 && above(largest, LARGEST * classes.smallest))
    voice.fail("keyword multiblob: radii from " + text(classes.smallest) + " to " + text(largest) +
               ": larger spheres have more points up to a ratio of 10; use group to select spheres, or "
               "multiblob_most 162 (less accurate beside the largest spheres)");
  const size_t needed = 1 + kind(largest);
  const bool half = settings.half || (unlike() && settings.points == 42);
  const bool others = models.empty() || half != smallest_is_half || before.unlike != classes.unlike;
  if (others) {
    models.clear();
    lone.clear();
    patterns.clear();
    swimmers.clear();
    add_model(settings.points, half);
    smallest_is_half = half;
  }
  for (const auto &larger : LARGER)
    if (larger.points > models.back().n && models.size() < needed) add_model(larger.points, true);
  words = models.back().n < 64 ? 1 : SD_MULTIBLOB_WORDS;
  return others || (unlike() && before.smallest != classes.smallest);
}

int Shells::kind(double a) const
{
  int kind = 0;
  if (!unlike()) return 0;
  for (const auto &larger : LARGER)
    if (larger.points > settings.points && larger.points <= settings.most &&
        above(a, larger.from * classes.smallest))
      kind++;
  return kind;
}

double Shells::looser() const
{
  double least = INFINITY;
  for (const sd_multiblob &model : models) least = std::min(least, sd_multiblob_looser(&model));
  return least;
}

void Shells::find(int n, const double *a, Places &places) const
{
  places.kind.resize(n + 1);
  places.first.resize(n + 1);
  places.first[0] = 0;
  for (int k = 0; k < n; k++) {
    places.kind[k] = kind(a[k]);
    places.first[k + 1] = places.first[k] + models[places.kind[k]].n;
  }
}

const double *Shells::free_turn()
{
  static const double unity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return unity;
}

/* By radius, which says how many points there are, as long as there are forms left */
void Shells::find_forms(const sd_multiblob_spheres &s)
{
  std::vector<double> radii;
  forms.assign(s.n, -1);
  for (int k = 0; k < s.n; k++) {
    if (!sd_multiblob_is_whole(&s, k)) continue;
    if (s.turn && !std::equal(free_turn(), free_turn() + 9, s.turn + 9 * (size_t) k)) continue;
    const size_t form = std::find(radii.begin(), radii.end(), s.a[k]) - radii.begin();
    if (form == radii.size() && form < SD_GROUP_FORMS) radii.push_back(s.a[k]);
    if (form < radii.size()) forms[k] = (int) form;
  }
}

void Shells::free_rows(int n, const double *a)
{
  find(n, a, of_rows);
  turn.clear();
  mask.clear();
}

void Shells::turn_row(int k, const double row[9], const sd_multiblob_mask &there)
{
  for (size_t i = mask.size(); i + 1 < of_rows.first.size(); i++) {
    mask.push_back(mask_of_free(i));
    turn.insert(turn.end(), free_turn(), free_turn() + 9);
  }
  std::copy_n(row, 9, &turn[9 * (size_t) k]);
  mask[k] = there;
}

std::vector<double> Shells::sent(int n) const
{
  const size_t width = sent_width();
  std::vector<double> rows(width * (n + 1));
  for (size_t k = 0; k < (size_t) n; k++) {
    const sd_multiblob_mask there = mask_of(k);
    std::copy_n(turn_of(k), 9, &rows[width * k]);
    std::memcpy(&rows[width * k + 9], there.word, words * sizeof(double));
  }
  return rows;
}

void Shells::expand(int n, const std::vector<double> &rows, const sd_spheres &spheres, std::vector<double> *room)
{
  const size_t width = sent_width(), turned = rows.size() / width;
  std::vector<double> turns(9 * turned);
  std::vector<sd_multiblob_mask> there(turned);
  for (size_t k = 0; k < turned; k++) {
    std::copy_n(&rows[width * k], 9, &turns[9 * k]);
    std::memcpy(there[k].word, &rows[width * k + 9], words * sizeof(double));
  }
  find(n, spheres.a, of_all);
  const sd_multiblob_spheres s = {spheres.x, spheres.a, turned ? turns.data() : nullptr,
                                  turned ? there.data() : nullptr, n, of_all.kind.data(), of_all.first.data()};
  find_forms(s);
  const size_t points = of_all.first[n];
  double *to = at_least(3 * points + 3, room ? *room : x);
  places = to;
  b.resize(points + 1);
  w.resize(points + 1);
  sd_multiblob_expand(models.data(), &s, nullptr, to, b.data());
  for (int k = 0; k < n; k++)
    std::fill(&w[of_all.first[k]], &w[0] + of_all.first[k + 1], spheres.w[k]);
}

double Shells::memory_usage() const
{
  double bytes = sizeof(double) * ((double) turn.capacity() + x.capacity() + b.capacity() + w.capacity()) +
      sizeof(sd_multiblob_mask) * (double) mask.capacity();
  for (const sd_multiblob &model : models) bytes += 9.0 * sizeof(double) * model.n * model.n;
  return bytes;
}

}    // namespace StokesDyn
