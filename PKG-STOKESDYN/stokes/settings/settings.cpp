#include "settings.h"

#include "keywords.h"

#include "sd_multiblob_half.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace StokesDyn {

StokesSettings::StokesSettings(LAMMPS *lmp, const std::vector<std::string> &words)
{
  Keywords in(lmp, COMMAND, words);
  in.elsewhere("temperature noise_tolerance held pin spin squirm torque scheme adapt", "fix stokes_dynamics/overdamped")
      .elsewhere("apply", "fix stokes_dynamics");
  Boundary::refuse_second(in, words);
  parse(in);
  if (!in.given("cut_off_distance")) scene.cutoff = INFINITY;
  rigid.clumps_only = scene.clumps_only;
  check(in);
  check_with_walls(in);
  if (!grid_file.empty()) {
    ambient.grid = FlowFile::read(Voice(lmp, COMMAND).of("keyword fluid_velocity"), grid_file);
    in.require(!ambient.grid_has_visc || ambient.grid->has_viscosity(),
               "keyword visc: 'grid': the file '" + grid_file +
                   "' has no viscosity: its columns would be ux uy uz eta");
  }
  if (scene.far_field_tolerance == 0.0)
    scene.far_field_tolerance = std::max(1e-13, 0.1 * tolerance);
  scene.residual = tolerance;
  // What Ewald sums have not got.
  if (scene.tensor == SD_TENSOR_OSEEN || precondition == SPARSE)
    scene.far_field = SceneSettings::DIRECT;
  // Points on a surface take torques, whether rotation is asked for or not.
  if (rigid.shell > 1 || shells.on()) scene.rotation = true;
  if (shells.on() && !in.given("lubrication_range")) lubrication.range = 1.0;
  rigid.rotation = scene.rotation;
  scene.whole = rigid.on || (scene.clumps_only && std::isinf(scene.cutoff));
  in.require(!scene.rotation || scene.tensor != SD_TENSOR_OSEEN,
             "keyword rotation: yes is not available with tensor oseen, whose point forces do not "
             "rotate");
  in.require(!in.given("fluid_vorticity") || scene.rotation,
             "keyword fluid_vorticity has no effect without rotation yes or a shell");
  if (tolerance > 0.1)
    Voice(lmp, COMMAND)
        .warn("keyword relative_tolerance: '" + text(tolerance) +
              "' allows errors of the forces of more than a tenth");
}

void StokesSettings::take_visc(Keywords &in)
{
  ambient.grid_has_visc = in.take("grid");
  if (ambient.grid_has_visc) return;
  ambient.visc = Field::parse(in);
  in.check(ambient.visc.is_variable() || ambient.visc.number() > 0.0, "must be > 0");
}

void StokesSettings::take_fluid_velocity(Keywords &in)
{
  if (in.take("grid"))
    grid_file = in.word();
  else if (!(ambient.box = in.take("box")))
    for (Field &u : ambient.velocity) u = Field::parse(in);
}

void StokesSettings::take_fluid_vorticity(Keywords &in)
{
  for (Field &w : ambient.vorticity) w = Field::parse(in);
  ambient.has_vorticity = true;
}

void StokesSettings::take_algorithm(Keywords &in)
{
  algorithm = in.choice({"1", "2"}) == 0 ? SUBSTITUTION : GRADIENTS;
  strict = algorithm == SUBSTITUTION && in.take("strict");
}

void StokesSettings::take_relative_tolerance(Keywords &in)
{
  tolerance = in.positive();
  in.check(tolerance < 1.0, "must be < 1: otherwise forces of 0 are a solution");
}

void StokesSettings::take_far_field_tolerance(Keywords &in)
{
  if (in.take("auto")) return;
  const double wanted = scene.far_field_tolerance = in.positive();
  in.check(wanted >= 1e-13 && wanted <= 0.1, "must be from 1e-13 to 0.1");
}

void StokesSettings::take_rigid_clumps(Keywords &in)
{
  const size_t choice = in.choice({"no", "yes", "auto"});
  rigid.on = choice > 0;
  rigid.auto_resolve = choice == 2;
}

void StokesSettings::take_shell(Keywords &in)
{
  rigid.shell = in.integer(1);
  in.check(rigid.shell == 1 || rigid.shell >= 12, "must be 1 or >= 12");
}

void StokesSettings::take_multiblob(Keywords &in)
{
  shells.points = in.integer(1);
  in.check(!shells.on() || sd_multiblob_has(shells.points) || shells.points == 162, "must be 1, 12, 42 or 162");
  const bool half = in.take("half");
  in.check(!half || shells.points == 42, "goes with 42 points alone: multiblob 42 half");
  shells.half = half || shells.points == 162;
}

void StokesSettings::take_multiblob_most(Keywords &in)
{
  shells.most = in.integer(1);
  in.check(shells.most == 12 || sd_multiblob_half_of(shells.most), "must be 12, 42, 162 or 642");
}

void StokesSettings::take_lubrication_gap(Keywords &in)
{
  lubrication.gap = in.positive();
  in.check(lubrication.gap >= 1e-6, "must be >= 1e-6, in mean radii of a pair");
}

void StokesSettings::take_lubrication_range(Keywords &in)
{
  lubrication.range = in.positive();
  in.check(lubrication.range <= SD_TWO_SPHERE_LARGEST_XI,    // of the films that it knows
           "must be <= 8, in mean radii of a pair");
}

void StokesSettings::parse(Keywords &in)
{
  in.parse({
      {"cut_off_distance", [&] { scene.cutoff = in.take("inf") ? INFINITY : in.positive(); }},
      {"update_every", [&] { update_every = in.integer(1); }},
      {"clumps_only", [&] { scene.clumps_only = in.yes_no(); }},
      {"visc", [&] { take_visc(in); }},
      {"region", [&] { ambient.region = in.word(); }},
      {"group", [&] { ambient.group = in.word(); }},
      {"add_force", [&] { add_force = in.yes_no(); }},
      {"relative_tolerance", [&] { take_relative_tolerance(in); }},
      {"max_iter", [&] { max_iter = in.integer(1); }},
      {"algorithm", [&] { take_algorithm(in); }},
      {"fluid_velocity", [&] { take_fluid_velocity(in); }},
      {"fluid_vorticity", [&] { take_fluid_vorticity(in); }},
      {"rotation", [&] { scene.rotation = in.yes_no(); }},
      {"tensor", [&] { scene.tensor = (sd_tensor) in.choice({"rpy", "oseen"}); }},
      {"rigid_clumps", [&] { take_rigid_clumps(in); }},
      {"shell", [&] { take_shell(in); }},
      {"multiblob", [&] { take_multiblob(in); }},
      {"multiblob_most", [&] { take_multiblob_most(in); }},
      {"one_body", [&] { shells.one_body = in.yes_no(); }},
      {"lubrication", [&] { lubrication.on = in.yes_no(); }},
      {"lubrication_gap", [&] { take_lubrication_gap(in); }},
      {"lubrication_range", [&] { take_lubrication_range(in); }},
      {"wall", [&] { scene.boundary.read_wall(in); }},
      {"flow", [&] { scene.boundary.read_flow(in); }},
      {"taper", [&] { scene.taper = (sd_taper) in.choice({"none", "wendland", "spherical"}); }},
      {"far_field", [&] { scene.far_field = in.choice({"auto", "direct", "ewald"}); }},
      {"far_field_tolerance", [&] { take_far_field_tolerance(in); }},
      {"precondition",
       [&] { precondition = (Precondition) in.choice({"auto", "none", "clump", "sparse", "waves"}); }},
      {"warm_start", [&] { warm_start = in.yes_no(); }},
  });
}

/* Of films and of shells of points */
void StokesSettings::check_close_spheres(const Keywords &in, bool all_pairs) const
{
  in.require(!lubrication.on || all_pairs,
             "keyword lubrication: yes requires cut_off_distance inf and clumps_only no, since it "
             "corrects the mobility matrix of all spheres");
  in.require(!lubrication.on || scene.rotation || rigid.shell > 1 || shells.on(),
             "keyword lubrication: yes requires rotation yes (or a shell)");
  in.require(!shells.on() || all_pairs,
             "keyword multiblob: '" + std::to_string(shells.points) +
                 "' requires cut_off_distance inf and clumps_only no");
  in.require(!shells.on() || scene.tensor != SD_TENSOR_OSEEN,
             "keyword multiblob is not available with tensor oseen: use tensor rpy");
  in.require(!shells.on() || !in.given("shell"),
             "keyword multiblob: the spheres of rigid clumps are shells of points already; leave "
             "out shell");
  in.require(!shells.on() || !in.given("rotation") || scene.rotation,
             "keyword multiblob: shells of points always rotate; leave out rotation no");
  in.require(!shells.on() || !in.given("precondition"),
             "keyword multiblob has its own preconditioner; leave out precondition");
  in.require(!shells.on() || lubrication.range <= SD_FILM_LARGEST_XI,
             "keyword lubrication_range: '" + text(lubrication.range) +
                 "' must be <= 2 with multiblob");
  in.require(!in.given("multiblob_most") || shells.on(), "keyword multiblob_most requires multiblob");
  in.require(!in.given("multiblob_most") || shells.most >= shells.points,
             "keyword multiblob_most: '" + std::to_string(shells.most) +
                 "' must not be less than multiblob, " + std::to_string(shells.points));
  in.require(!in.given("one_body") || shells.on(), "keyword one_body requires multiblob");
  in.require(!in.given("lubrication_gap") || lubrication.on,
             "keyword lubrication_gap requires lubrication yes");
  in.require(!in.given("lubrication_range") || lubrication.on,
             "keyword lubrication_range requires lubrication yes");
  in.require(lubrication.gap < lubrication.range,
             "keyword lubrication_gap: '" + text(lubrication.gap) +
                 "' must be below lubrication_range, " + text(lubrication.range));
}

/* Which keywords go together. */
void StokesSettings::check(const Keywords &in) const
{
  const bool all_pairs = scene.everybody(), by_ewald = scene.far_field == SceneSettings::EWALD;
  in.require(in.given("visc"), "keyword visc is required: the dynamic viscosity");
  in.require(!ambient.grid_has_visc || !grid_file.empty(),
             "keyword visc: 'grid' requires fluid_velocity grid FILE");
  in.require(!ambient.box || !ambient.has_vorticity,
             "keyword fluid_vorticity: fluid_velocity box has a vorticity of its own");
  in.require(in.given("cut_off_distance") || scene.clumps_only,
             "keyword cut_off_distance is required (a distance or inf) unless clumps_only yes");
  in.require(scene.taper == SD_TAPER_NONE || std::isfinite(scene.cutoff),
             "keyword taper requires a cut_off_distance, its range");
  in.require(precondition != SPARSE || all_pairs,
             "keyword precondition: 'sparse' requires cut_off_distance inf and clumps_only no");
  in.require(precondition != SPARSE || !by_ewald,
             "keyword precondition: 'sparse' is not available with far_field ewald");
  in.require(!in.given("far_field") || all_pairs,
             "keyword far_field requires cut_off_distance inf and clumps_only no");
  in.require(!in.given("far_field_tolerance") ||
                 (all_pairs && scene.far_field != SceneSettings::DIRECT),
             "keyword far_field_tolerance requires cut_off_distance inf, clumps_only no, and "
             "far_field auto or ewald");
  in.require(!by_ewald || scene.tensor != SD_TENSOR_OSEEN,
             "keyword far_field: 'ewald' is not available with tensor oseen");
  check_close_spheres(in, all_pairs);
  in.require(precondition != SPARSE || algorithm == GRADIENTS,
             "keyword precondition: 'sparse' requires algorithm 2");
  in.require(precondition != WAVES || (all_pairs && algorithm == GRADIENTS),
             "keyword precondition: 'waves' requires cut_off_distance inf, clumps_only no and "
             "algorithm 2");
  in.require(precondition != CLUMP || algorithm == GRADIENTS,
             "keyword precondition: 'clump' requires algorithm 2");
  in.require(!rigid.auto_resolve || scene.clumps_only,
             "keyword rigid_clumps: 'auto' requires clumps_only yes");
  in.require(!rigid.on || !scene.clumps_only || std::isinf(scene.cutoff),
             "keyword rigid_clumps: no cut_off_distance may be given with clumps_only yes, since a "
             "clump is solved as a whole");
  in.require(!rigid.on || scene.clumps_only || scene.rotation || rigid.shell > 1 || shells.on(),
             "keyword rigid_clumps: with clumps_only no, rotation yes (or a shell) is required");
  in.require(!in.given("shell") || rigid.on, "keyword shell requires rigid_clumps yes");
  in.require(!rigid.on || scene.tensor != SD_TENSOR_OSEEN,
             "keyword rigid_clumps is not available with tensor oseen");
}

/* What does not go with a wall, or with flow; torques of spheres of one point, for whose images there is no Ewald
 * sum, are summed over all pairs. */
void StokesSettings::check_with_walls(const Keywords &in)
{
  const Boundary &boundary = scene.boundary;
  in.require(!in.given("flow") || boundary.walls == 2,
             "keyword flow requires two walls (wall zlo ... zhi ...): it says what drives the fluid "
             "between them");
  if (!boundary.walled()) return;
  const bool torques = scene.rotation && !shells.on();
  in.require(scene.tensor != SD_TENSOR_OSEEN,
             "keyword wall is not available with tensor oseen: use tensor rpy");
  in.require(scene.far_field != SceneSettings::EWALD || !torques,
             "keyword wall: far_field ewald has no images of torques in a wall: use multiblob 12 in "
             "place of rotation yes, or far_field auto, which takes all pairs");
  in.require(precondition != WAVES,
             "keyword wall: precondition waves is for periodic boxes: use precondition auto");
  in.require(!rigid.each_alone(),
             "keyword wall: with clumps_only yes rigid clumps have a resistance that is computed "
             "once, without the wall: use cut_off_distance inf and multiblob 12");
  in.require(rigid.shell == 1,
             "keyword wall: a shell is computed once, without the wall: use multiblob 12 in its "
             "place");
  if (torques) scene.far_field = SceneSettings::DIRECT;
}

}    // namespace StokesDyn
