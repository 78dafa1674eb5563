#include "clump_shapes.h"

#include "keywords.h"
#include "shells.h"

#include "comm.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

using namespace LAMMPS_NS;

namespace StokesDyn {

static const double SOLVE_MEMORY = 4e9;    // bytes that the solve of a shape may take

void ClumpShapes::clear()
{
  by_size.clear();
  shapes.clear();
  solved = 0;
  sd_shells_free(&shells);
}

void ClumpShapes::keep(const std::set<int> &used)
{
  for (auto s = by_size.begin(); s != by_size.end();)
    s = used.count(s->second->number) ? std::next(s) : by_size.erase(s);
  for (auto s = shapes.begin(); s != shapes.end();)
    s = used.count(s->first) ? std::next(s) : shapes.erase(s);
}

void ClumpShapes::drop_unsolved()
{
  std::set<int> good;
  for (const auto &s : shapes)
    if (s.first <= solved) good.insert(s.first);
  keep(good);
}

double ClumpShapes::memory_usage() const
{
  double bytes = 0.0;
  for (const auto &s : shapes) bytes += 72.0 * sizeof(double) * s.second->shape.n;
  return bytes;
}

bool ClumpShapes::fits(const sd_shape &shape, const ClumpGeometry &spheres, std::vector<int> &perm)
{
  std::vector<double> scratch(6 * spheres.a.size());
  perm.resize(spheres.a.size());
  return sd_shape_match(&shape, spheres.n(), spheres.x.data(), spheres.a.data(), perm.data(),
                        scratch.data());
}

const ClumpShape *ClumpShapes::find(const ClumpGeometry &spheres, std::vector<int> &perm) const
{
  const double size = sd_shape_size(spheres.n(), spheres.x.data(), spheres.a.data());
  const double near = 2.01 * SD_SHAPE_TOLERANCE * size;
  const ClumpShape *first = nullptr;
  for (auto s = by_size.lower_bound(size - near); s != by_size.end() && s->first <= size + near;
       ++s) {
    std::vector<int> order;
    if ((first && first->number < s->second->number) || !fits(s->second->shape, spheres, order))
      continue;
    first = s->second;
    perm.swap(order);
  }
  return first;
}

sd_status ClumpShapes::add(int64_t molecule, const ClumpGeometry &spheres)
{
  const int number = std::max(solved, shapes.empty() ? 0 : shapes.rbegin()->first) + 1;
  std::unique_ptr<ClumpShape> s(new ClumpShape(number, molecule));
  const sd_status status =
      sd_shape_create(spheres.n(), spheres.x.data(), spheres.a.data(), &s->shape);
  if (status != SD_OK) return status;
  by_size.insert({s->shape.size, s.get()});
  shapes[number] = std::move(s);
  return SD_OK;
}

// --- resistances ---------------------------------------------------------------------------------

namespace {
  struct Progress {
    FILE *screen;
    double last;
    std::string what;
  };

  void show_progress(void *ctx, int solve, int solves, int products)
  {
    Progress *p = static_cast<Progress *>(ctx);
    const double now = MPI_Wtime();
    if (!p->screen || now - p->last < 5.0) return;
    p->last = now;
    fprintf(p->screen, "  %s: solve %d of %d, iteration %d\n", p->what.c_str(), solve + 1, solves,
            products);
    fflush(p->screen);
  }
}    // namespace

void ClumpShapes::cannot_be_solved(int64_t molecule, int spheres, const ClumpModel &model,
                                   sd_status status, double need) const
{
  const Voice who = voice.of("keyword rigid_clumps: the clump of molecule " +
                             std::to_string(molecule) + ", " + std::to_string(spheres) +
                             " spheres, shell " + std::to_string(model.shell));
  if (status == SD_ENOMEMORY)
    who.fail("its resistance needs " + text(need / 1e9) + " GB, more than " +
             text(SOLVE_MEMORY / 1e9) + "; use a smaller shell");
  if (status == SD_ESINGULAR)
    who.fail("two of its spheres of equal radius are at one point");
  who.fail(sd_status_string(status));
}

/* Resistances of the new shapes, shared out among the ranks. */
void ClumpShapes::solve(const ClumpModel &model)
{
  struct Solved {
    sd_status status;
    double need, seconds;
  };
  std::map<int, Solved> results;
  int turn = 0;
  const auto first = shapes.upper_bound(solved);
  for (auto at = first; at != shapes.end(); ++at, turn++) {
    if (turn % comm->nprocs != comm->me) continue;
    ClumpShape &s = *at->second;
    Progress progress = {screen, MPI_Wtime(),
                         "shape " + std::to_string(s.number) + ", the clump of molecule " +
                             std::to_string(s.molecule)};
    sd_clump_options options = SD_CLUMP_OPTIONS;
    options.shell = model.shell;
    options.rotation = model.rotation;
    options.memory = SOLVE_MEMORY;
    options.progress = show_progress;
    options.progress_ctx = &progress;
    sd_clump_need need = {};
    const double start = MPI_Wtime();
    const sd_status status = sd_clump_create(&s.shape, &options, &shells, &s.clump, &need);
    results[s.number] = {status, std::min(need.dense, need.iterative), MPI_Wtime() - start};
  }
  // Only now the ranks wait for each other.
  turn = 0;
  for (auto at = first; at != shapes.end(); ++at, turn++) {
    ClumpShape &s = *at->second;
    const int root = turn % comm->nprocs;
    Solved r = results[s.number];
    MPI_Bcast(&r, sizeof(r), MPI_BYTE, root, world);
    if (r.status != SD_OK) cannot_be_solved(s.molecule, s.shape.n, model, r.status, r.need);
    sd_clump clump = s.clump;
    MPI_Bcast(&clump, sizeof(clump), MPI_BYTE, root, world);
    const int size = 72 * s.shape.n;
    clump.table = comm->me == root ? s.clump.table : (double *) malloc(sizeof(double) * size);
    if (!clump.table) voice.fail_one("keyword rigid_clumps: out of memory");
    static_cast<sd_clump &>(s.clump) = clump;
    MPI_Bcast(s.clump.table, size, MPI_DOUBLE, root, world);
    sd_clump_noise_of(&s.clump, &s.noise);
    announce(s, r.seconds);
  }
  if (!shapes.empty()) solved = std::max(solved, shapes.rbegin()->first);
}

/* What may fail where a shape is first needed */
static void check_blocks(const Voice &voice, const ClumpShape &s, sd_status status)
{
  if (status != SD_OK)
    voice.fail_one("keyword rigid_clumps: the clump of molecule " + std::to_string(s.molecule) +
                   ", " + std::to_string(s.shape.n) + " spheres: " + sd_status_string(status));
}

const sd_body_shape &ClumpShapes::blocks(const ClumpShape &s, const ClumpModel &model) const
{
  if (s.body.m == 0)
    check_blocks(voice, s,
                 sd_body_shape_create(&s.shape, model.shell > 1 ? &s.clump : nullptr, &s.body));
  return s.body;
}

const sd_multiblob_shape &ClumpShapes::points(const ClumpShape &s, const Shells &of) const
{
  if (s.points.spheres > 0) return s.points;
  std::vector<int> kind;
  for (int k = 0; k < s.shape.n; k++) kind.push_back(of.kind(s.shape.a[k]));
  check_blocks(voice, s,
               sd_multiblob_shape_create(of.all_models(), &s.shape, kind.data(), &s.points));
  return s.points;
}

void ClumpShapes::forget_points()
{
  for (const auto &s : shapes) sd_multiblob_shape_free(&s.second->points);
}

void ClumpShapes::announce(const ClumpShape &s, double seconds) const
{
  if (comm->me != 0) return;
  const sd_clump &c = s.clump;
  std::string out = "Rigid clumps, shape " + std::to_string(s.number) + " (molecule " +
      std::to_string(s.molecule) + "): " + std::to_string(s.shape.n) + " spheres, " +
      std::to_string(c.points) + " points, hydrodynamic radius " + text(c.radius) + ", solved in " +
      text(seconds) + " s" +
      (c.iterations ? ", " + std::to_string(c.iterations) + " iterations" : "") + "\n";
  out += "  centre of hydrodynamic stress, from the centroid of centres:";
  for (double d : c.centre) out += " " + text(fabs(d) < 1e-12 * s.shape.size ? 0.0 : d);
  out += "\n  resistance about it over viscosity, force and torque from velocity and angular "
         "velocity:\n";
  for (int p = 0; p < 6; p++) {
    out += "   ";
    for (int q = 0; q < 6; q++) {
      const double r = c.R_centre[6 * p + q];
      const double rounding = 1e-12 * sqrt(c.R_centre[7 * p] * c.R_centre[7 * q]);
      char number_text[24];
      snprintf(number_text, sizeof(number_text), " %13.6g", fabs(r) <= rounding ? 0.0 : r);
      out += number_text;
    }
    out += "\n";
  }
  utils::logmesg(lmp, out);
}

}    // namespace StokesDyn
