#include "vans_settings.h"

#include "vans_files.h"

#include "comm.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Steps times slices of one solve: at 5 ns each that is most of a minute in every coupling. */
static const double MOST_WORK = 1e10;

static std::string file_name(Keywords &in)
{
  in.choice({"file"});
  return in.word();
}

/* A file, or the word that stands for none. */
static std::string file_or(Keywords &in, const char *none)
{
  return in.take(none) ? std::string() : file_name(in);
}

static Field one_for_all(Keywords &in)
{
  return Field::parse(in, Field::ONE_FOR_ALL);
}

static double fraction(Keywords &in)
{
  const double value = in.positive();
  if (value > 1.0) in.refuse("'" + text(value) + "' is a volume fraction and must be <= 1");
  return value;
}

void VansSettings::take_mesh(Keywords &in)
{
  if (in.more() && in.peek() == "file") {
    mesh_file = file_name(in);
    return;
  }
  edge.resize(in.value("ncell").integer(2, 10000000) + 1);
  mesh.dz = in.value("dz").positive();
  mesh.z_ref = in.value("zref").number();
  for (size_t k = 0; k < edge.size(); k++) edge[k] = (double) k * mesh.dz;
}

void VansSettings::check_solve(const Voice &what, double T, double step) const
{
  if (step > T * (1.0 + 1e-9))
    what.fail("the step " + text(step) + " is longer than the period " + text(T));
  if (!(T / step * ncell() <= MOST_WORK))
    what.fail("the step " + text(step) + " is too short for the period " + text(T) + ": " +
              text(T / step) + " steps of " + std::to_string(ncell()) +
              " slices in every coupling would take most of a minute");
}

void VansSettings::take_classes(Keywords &in)
{
  classes = true;
  if (in.take("yes")) return;
  if (in.take("no"))
    classes = false;
  else
    bins = (int) in.integer(1, 1000);
}

void VansSettings::take_class_radii(Keywords &in)
{
  class_radii.resize(in.integer(1, 32));
  for (size_t c = 0; c < class_radii.size(); c++) {
    class_radii[c] = in.positive();
    if (std::count(class_radii.begin(), class_radii.begin() + c, class_radii[c]))
      in.refuse("'" + text(class_radii[c]) + "' is given twice");
  }
}

void VansSettings::take_fluctuation(Keywords &in)
{
  fluctuations.kind = in.option<Fluctuations::Kind>(
      {"none", "correlated", "uncorrelated", "depth", "langevin"});
  if (!fluctuates()) return;
  fluctuations.seed = (uint64_t) in.value("seed").integer(1, std::numeric_limits<bigint>::max());
  fluctuations.find_bed = in.take("auto");
  if (!fluctuations.find_bed) fluctuations.bed = in.value("bed").number();
}

void VansSettings::take_intensity(Keywords &in)
{
  if (in.take("stress")) return;
  fluctuations.intensity_given = true;
  if (in.more() && in.peek() == "file")
    intensity_file = file_name(in);
  else
    fluctuations.intensity = one_for_all(in);
  if (fluctuations.intensity.number() < 0.0) in.refuse("'" + text(fluctuations.intensity.number()) + "' must be >= 0");
}

void VansSettings::take_fluid(Keywords &in)
{
  fluid.rho = law.rho = in.value("rho").positive();
  fluid.eta = law.eta = in.value("eta").positive();
}

void VansSettings::take_gravity(Keywords &in)
{
  for (int d = 0; d < 3; d++) {
    gravity[d] = one_for_all(in);
    law.g[d] = gravity[d].number();
  }
}

void VansSettings::take_drag(Keywords &in)
{
  drag_given = true;
  law.drag.law = in.option<sd_drag_of_one>({"yade", "schiller_naumann", "brown_lawler", "ferguson_church", "ergun",
                                            "gidaspow", "beetstra", "koch_hill"});
}

void VansSettings::take_hindrance(Keywords &in)
{
  if (in.take("richardson_zaki"))
    law.drag.hindrance = SD_HINDRANCE_RICHARDSON_ZAKI;
  else if (in.take("di_felice"))
    law.drag.hindrance = SD_HINDRANCE_DI_FELICE;
  else
    law.exponent = in.not_negative();
}

void VansSettings::take_surface(Keywords &in)
{
  const size_t kind = in.choice({"free", "speed", "follow"});
  fluid.driven = kind == 1;
  if (kind == 1) u_top = one_for_all(in);
  if (kind == 2) surface = in.positive();
}

void VansSettings::take_sidewall(Keywords &in)
{
  if (in.take("off")) return;
  fluid.width = in.value("width").positive();
  fluid.wall_coef = in.value("coef").not_negative();
}

void VansSettings::read(Keywords &in)
{
  in.parse({
      {"mesh", [&] { take_mesh(in); }},
      {"fluid", [&] { take_fluid(in); }},
      {"gravity", [&] { take_gravity(in); }},
      {"area", [&] { area = in.positive(); }},
      {"couple", [&] { couple = in.option<decltype(couple)>({"none", "one", "two", "fluid"}); }},
      {"profile", [&] { profile_file = file_or(in, "zero"); }},
      {"given", [&] { given_file = file_or(in, "averaged"); }},
      {"convective", [&] { convective_file = file_or(in, "off"); }},
      {"solve", [&] { period = in.value("period").positive(), dt = in.value("dt").positive(); }},
      {"stream", [&] { law.rest = in.choice({"steady", "rest"}) == 1; }},
      {"drag", [&] { take_drag(in); }},
      {"fall_diameter", [&] { law.drag.fall = in.positive(); }},
      {"hindrance", [&] { take_hindrance(in); }},
      {"added_mass", [&] { law.added_mass = in.take("off") ? 0.0 : in.not_negative(); }},
      {"upflow", [&] { if ((upflow = !in.take("off"))) flux = one_for_all(in); }},
      {"lift", [&] { law.lift = in.take("off") ? 0.0 : in.number(); }},
      {"turbulence",
       [&] {
         fluid.turbulence = in.option<sd_vans_turbulence>({"none", "kz", "parabolic", "li_sawamoto", "pore",
                                                           "rousseau", "ni_capart", "pipe"});
       }},
      {"kappa", [&] { fluid.kappa = in.positive(); }},
      {"phi_max", [&] { fluid.phi_max = fraction(in); }},
      {"phi_bed", [&] { fluid.phi_bed = fraction(in); }},
      {"bed_average", [&] { bed_average = (int) in.integer(1, 1000000); }},
      {"sublayer", [&] { fluid.sublayer = in.yes_no(); }},
      {"viscosity", [&] { fluid.viscosity = in.option<sd_vans_viscosity>({"constant", "einstein", "power"}); }},
      {"surface", [&] { take_surface(in); }},
      {"discharge", [&] { if ((fluid.held = !in.take("off"))) discharge = one_for_all(in); }},
      {"adjust", [&] { reach = in.choice({"slope", "depth"}) == 1 ? in.positive() : 0.0; }},
      {"pressure_gradient", [&] { dpdx = one_for_all(in); }},
      {"sidewall", [&] { take_sidewall(in); }},
      {"wall_roughness", [&] { fluid.wall_roughness = in.not_negative(); }},
      {"wall_mixing", [&] { fluid.narrow = in.yes_no(); }},
      {"bed_mixing", [&] { fluid.bed_mixing = in.take("off") ? 0.0 : in.not_negative(); }},
      {"radius", [&] { radius = in.positive(); }},
      {"classes", [&] { take_classes(in); }},
      {"class_radii", [&] { take_class_radii(in); }},
      {"grains", [&] { point = in.choice({"extended", "point"}) == 1; }},
      {"felt", [&] { law.felt_by_volume = in.choice({"centre", "volume"}) == 1; }},
      {"fluctuation", [&] { take_fluctuation(in); }},
      {"intensity", [&] { take_intensity(in); }},
      {"renewal", [&] { fluctuations.renewal = in.positive(); }},
      {"schmidt", [&] { fluctuations.schmidt = in.positive(); }},
      {"rules", [&] { fluid.rules = law.rules = in.option<sd_vans_rules>({"consistent", "yade"}); }},
      {"conserve", [&] { conserve = in.yes_no(); }},
      {"overlap",
       [&] {
         overlap_once = in.choice({"twice", "once"}) == 1;
         overlap_given = true;
       }},
      {"region", [&] { region = in.word(); }},
      {"average", [&] { average = in.word(); }},
  });
}

/* What the rules of the original have not got */
void VansSettings::check_yade(const Keywords &in) const
{
  if (!yade()) return;
  in.require(mesh_file.empty(), "keyword mesh: rules yade needs slices of equal height, mesh ncell dz zref");
  in.require(!law.felt_by_volume,
             "keyword felt is not available with rules yade: grains feel the water at their centre");
  in.require(fluctuations.kind != Fluctuations::LANGEVIN,
             "keyword fluctuation: langevin is not available with rules yade");
  in.require(law.drag.fall == 0.0, "keyword fall_diameter is not available with rules yade");
  in.require(law.drag.law == SD_DRAG_YADE && law.drag.hindrance == SD_HINDRANCE_POWER,
             "keyword drag: with rules yade only drag yade and hindrance n are available");
  in.require(law.added_mass == 0.0, "keyword added_mass is not available with rules yade");
  in.require(fluid.wall_roughness == 0.0 && !fluid.narrow,
             "keywords wall_roughness and wall_mixing are not available with rules yade");
  in.require(fluid.bed_mixing == 0.0, "keyword bed_mixing is not available with rules yade");
}

/* Rules between keywords. */
void VansSettings::check(const Keywords &in) const
{
  in.require(in.given("mesh"), "keyword mesh (ncell dz zref, or file NAME) is required");
  in.require(in.given("fluid"), "keyword fluid (density and viscosity) is required");
  in.require(in.given("gravity"),
             "keyword gravity (gx gy gz) is required; its x component is the slope");
  check_yade(in);
  in.require(!law.felt_by_volume || !point, "keyword felt has no effect with grains point");
  in.require(!in.given("renewal") || fluctuates(), "keyword renewal requires fluctuations");
  in.require(!in.given("renewal") || fluctuations.kind != Fluctuations::DEPTH,
             "keyword renewal has no effect with fluctuation depth: each grain has a time of its own");
  in.require(!in.given("intensity") || fluctuates(), "keyword intensity requires fluctuations");
  in.require(!fluctuates() || has_grains(),
             "keyword fluctuation: with couple fluid there are no grains that could feel it");
  in.require(!in.given("schmidt") || fluctuations.kind == Fluctuations::LANGEVIN,
             "keyword schmidt requires fluctuation langevin");
  in.require(!in.given("hindrance") || !sd_drag_of_bed(law.drag.law),
             "keyword hindrance: ergun, gidaspow, beetstra and koch_hill have the neighbours of a grain in them: "
             "leave hindrance out");
  in.require(!upflow || (averages() && !yade()),
             "keyword upflow: it needs couple one or two, and rules consistent");
  in.require(reach == 0.0 || (fluid.held && follows()),
             "keyword adjust: depth needs discharge and surface follow");
  in.require(!fluid.held || (solves() && !yade()),
             "keyword discharge: it needs couple two or fluid, and rules consistent");
  in.require(!fluid.held || !fluid.driven,
             "keyword discharge: with surface speed the stream is driven already, "
             "leave one of the two out");
  in.require(!fluid.held || reach > 0.0 || !in.given("pressure_gradient"),
             "keyword discharge: the pressure gradient follows from it, "
             "leave pressure_gradient out");
  in.require(!bins || class_radii.empty(),
             "keyword classes: with a number of classes they are bins of equal ratio, and class_radii has no "
             "effect: leave one of the two out");
  in.require(!follows() || (couple == TWO && !yade()),
             "keyword surface: follow needs couple two and rules consistent");
  const bool walls = fluid.width > 0.0;
  in.require(walls || fluid.wall_roughness == 0.0, "keyword wall_roughness requires sidewall");
  in.require(walls || !fluid.narrow, "keyword wall_mixing requires sidewall");
  in.require(fluid.bed_mixing == 0.0 || fluid.turbulence != SD_VANS_LAMINAR,
             "keyword bed_mixing has no effect with turbulence none");
  const bool stands = !gravity[0].is_variable() && law.g[0] == 0.0 && !dpdx.is_variable() &&
      dpdx.number() == 0.0 && !fluid.driven && profile_file.empty();
  in.require(!solves() || law.rest || !stands || (fluid.held && reach == 0.0),
             "nothing drives the stream: give gravity an x component (the slope), "
             "pressure_gradient, discharge, surface speed or a profile, or stream rest");
}

void VansSettings::read_files()
{
  const int N = ncell();
  if (!given_file.empty())
    given = read_given(voice.of("keyword given"), given_file, N, class_radii.size());
  else if (!has_grains())
    given.assign(3, std::vector<double>(N, 0.0));
  if (!profile_file.empty()) profile = read_profile(voice.of("keyword profile"), profile_file, N);
  if (!convective_file.empty())
    convective = read_list(voice.of("keyword convective"), convective_file, N, "ncell");
  law.convective = convective.empty() ? nullptr : convective.data();
  if (intensity_file.empty()) return;
  const Voice what = voice.of("keyword intensity");
  fluctuations.intensities = read_list(what, intensity_file, N, "ncell");
  for (int n = 0; n < N; n++)
    if (fluctuations.intensities[n] < 0.0)
      what.fail("file '" + intensity_file + "': '" + text(fluctuations.intensities[n]) + "' in row " +
                std::to_string(n + 1) + " must be >= 0");
}

VansSettings::VansSettings(LAMMPS *lmp, const std::vector<std::string> &args) :
    voice(lmp, "Fix hydro/vans")
{
  law.exponent = 3.1;
  fluid.turbulence = SD_VANS_LI_SAWAMOTO;
  fluid.kappa = 0.41;
  fluid.phi_max = 0.64;
  fluid.phi_bed = 0.08;
  Keywords in(lmp, voice.command, args, 3);
  every = (int) in.positional("N").integer(1, 1000000000);
  read(in);
  check(in);
  /* a law other than Yade's is one for lone grains, without Yade's exponent */
  if (!in.given("hindrance") && law.drag.law != SD_DRAG_YADE)
    law.drag.hindrance = SD_HINDRANCE_RICHARDSON_ZAKI;
  if (sd_drag_of_bed(law.drag.law)) law.drag.hindrance = SD_HINDRANCE_OWN;
  fluid.drag = law.drag;
  if (yade() || couple != TWO) conserve = false;
  if (!mesh_file.empty()) edge = read_edges(voice.of("keyword mesh"), mesh_file, mesh.z_ref);
  mesh.ncell = (int) edge.size() - 1;
  mesh.edge = edge.data();
  read_files();
  fluid.gx = law.g[0];
  fluid.dpdx = dpdx.number();
  fluid.u_top = u_top.number();
  fluid.discharge = discharge.number();
  if (reach > 0.0) fluid.held = 0;
  if (follows() && !(surface < edge[mesh.ncell - 1]))
    voice.of("keyword surface").fail("the surface at " + text(surface) +
        " has no room to rise: the mesh holds water up to " + text(edge[mesh.ncell - 1]) +
        ", give it more slices");
  if (period > 0.0) check_solve(voice.of("keyword solve"), period, dt);
}

}    // namespace StokesDyn
