#include "vans_settings.h"

#include "comm.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <mpi.h>

using namespace LAMMPS_NS;

namespace StokesDyn {

/* Steps times slices of one solve: at 5 ns each that is most of a minute in every coupling. */
static const double MOST_WORK = 1e10;

std::vector<std::vector<double>> read_rows(LAMMPS *lmp, const std::string &what,
                                           const std::string &file)
{
  std::string text;
  int size = -1;
  if (lmp->comm->me == 0) {
    FILE *fp = fopen(file.c_str(), "r");
    if (fp) {
      char buffer[4096];
      size_t n;
      while ((n = fread(buffer, 1, sizeof(buffer), fp)) > 0) text.append(buffer, n);
      fclose(fp);
      size = (int) text.size();
    }
  }
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  if (size < 0) fail(lmp, what + ": cannot read file '" + file + "'");
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, 0, lmp->world);

  std::vector<std::vector<double>> rows;
  int line_number = 0;
  for (size_t at = 0; at < text.size();) {
    size_t end = text.find('\n', at);
    if (end == std::string::npos) end = text.size();
    std::string line = text.substr(at, end - at);
    at = end + 1;
    line_number++;
    line = line.substr(0, line.find('#'));
    std::vector<double> row;
    for (size_t p = 0;;) {
      p = line.find_first_not_of(" \t\r,", p);
      if (p == std::string::npos) break;
      const size_t q = line.find_first_of(" \t\r,", p);
      const std::string word = line.substr(p, q == std::string::npos ? q : q - p);
      double value;
      if (!is_number(word, value) || !std::isfinite(value))
        fail(lmp,
             what + ": file '" + file + "', line " + std::to_string(line_number) + ": '" + word +
                 "' is not a finite number");
      row.push_back(value);
      if (q == std::string::npos) break;
      p = q;
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

static std::string keyword(const char *name)
{
  return std::string(VansSettings::COMMAND) + ": keyword " + name;
}

/* One number a row, or all of them in one row: a table of several columns is something else. */
static std::vector<double> read_list(LAMMPS *lmp, const std::string &what, const std::string &file,
                                     size_t expected, const std::string &count)
{
  const auto rows = read_rows(lmp, what, file);
  std::vector<double> list;
  for (size_t k = 0; k < rows.size(); k++) {
    if (rows.size() > 1 && rows[k].size() > 1)
      fail(lmp,
           what + ": file '" + file + "': row " + std::to_string(k + 1) + " has " +
               std::to_string(rows[k].size()) + " values, one a row is needed");
    list.insert(list.end(), rows[k].begin(), rows[k].end());
  }
  if (expected && list.size() != expected)
    fail(lmp,
         what + ": file '" + file + "' has " + std::to_string(list.size()) + " values, " + count +
             " = " + std::to_string(expected) + " are needed");
  return list;
}

std::vector<double> read_profile(LAMMPS *lmp, const std::string &what, const std::string &file,
                                 int ncell)
{
  return read_list(lmp, what, file, ncell + 1, "ncell + 1");
}

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
  edge.resize(in.integer(2, 10000000) + 1);
  dz = in.positive();
  z_ref = in.number();
  for (size_t k = 0; k < edge.size(); k++) edge[k] = (double) k * dz;
}

void VansSettings::take_solve(Keywords &in)
{
  period = in.positive();
  dt = in.positive();
  if (dt > period * (1.0 + 1e-9))
    in.refuse("the step " + text(dt) + " is longer than the period " + text(period));
}

void VansSettings::take_class_radii(Keywords &in)
{
  class_radii.resize(in.integer(1, 32));
  for (size_t c = 0; c < class_radii.size(); c++) {
    class_radii[c] = in.positive();
    if (std::count(class_radii.begin(), class_radii.begin() + c, class_radii[c]))
      in.refuse("'" + text(class_radii[c]) + "' twice");
  }
}

void VansSettings::take_fluctuation(Keywords &in)
{
  fluctuation =
      (decltype(fluctuation)) in.choice({"none", "correlated", "uncorrelated", "depth"});
  if (fluctuation == NO_FLUCTUATION) return;
  seed = (uint64_t) in.integer(1, std::numeric_limits<bigint>::max());
  find_bed = in.take("auto");
  if (!find_bed) bed = in.number();
}

void VansSettings::take_sidewall(Keywords &in)
{
  if (in.take("off")) return;
  width = in.positive();
  wall_coef = in.not_negative();
}

void VansSettings::read(Keywords &in)
{
  const auto fluid = [&] {
    rho = in.positive();
    eta = in.positive();
  };
  const auto gravity = [&] {
    for (double &component : g) component = in.number();
  };
  const auto surface = [&] {
    driven = in.choice({"free", "speed"}) == 1;
    if (driven) u_top = Field::parse(in);
  };
  const auto closure = [&] {
    turbulence = (sd_vans_turbulence) in.choice(
        {"none", "kz", "parabolic", "li_sawamoto", "pore", "rousseau", "ni_capart", "pipe"});
  };
  const auto coupling = [&] {
    couple = (decltype(couple)) in.choice({"none", "one", "two", "fluid"});
  };
  const auto rule = [&] {
    rules = in.choice({"consistent", "yade"}) == 1 ? SD_VANS_YADE : SD_VANS_CONSISTENT;
  };
  in.parse({
      {"mesh", [&] { take_mesh(in); }},
      {"fluid", fluid},
      {"gravity", gravity},
      {"area", [&] { area = in.positive(); }},
      {"couple", coupling},
      {"profile", [&] { profile_file = file_or(in, "zero"); }},
      {"given", [&] { given_file = file_or(in, "averaged"); }},
      {"convective", [&] { convective_file = file_or(in, "off"); }},
      {"solve", [&] { take_solve(in); }},
      {"stream", [&] { rest = in.choice({"steady", "rest"}) == 1; }},
      {"hindrance", [&] { hindrance = in.number(); }},
      {"lift", [&] { lift = in.take("off") ? 0.0 : in.number(); }},
      {"turbulence", closure},
      {"kappa", [&] { kappa = in.positive(); }},
      {"phi_max", [&] { phi_max = fraction(in); }},
      {"phi_bed", [&] { phi_bed = fraction(in); }},
      {"bed_average", [&] { bed_average = (int) in.integer(1, 1000000); }},
      {"sublayer", [&] { sublayer = in.yes_no(); }},
      {"viscosity",
       [&] { viscosity = (sd_vans_viscosity) in.choice({"constant", "einstein", "power"}); }},
      {"surface", surface},
      {"pressure_gradient", [&] { dpdx = Field::parse(in); }},
      {"sidewall", [&] { take_sidewall(in); }},
      {"radius", [&] { radius = in.positive(); }},
      {"classes", [&] { classes = in.yes_no(); }},
      {"class_radii", [&] { take_class_radii(in); }},
      {"grains", [&] { point = in.choice({"extended", "point"}) == 1; }},
      {"fluctuation", [&] { take_fluctuation(in); }},
      {"renewal", [&] { renewal = in.positive(); }},
      {"rules", rule},
      {"conserve", [&] { conserve = in.yes_no(); }},
      {"overlap", [&] { overlap_once = in.choice({"twice", "once"}) == 1; }},
      {"region", [&] { region = in.word(); }},
      {"average", [&] { average = in.word(); }},
  });
}

/* Rules between keywords. */
void VansSettings::check(const Keywords &in) const
{
  const bool eddies = fluctuation != NO_FLUCTUATION;
  in.require(in.given("mesh"), "keyword mesh (ncell dz zref, or file NAME) is required");
  in.require(in.given("fluid"), "keyword fluid (density and viscosity) is required");
  in.require(in.given("gravity"),
             "keyword gravity (gx gy gz) is required; its x component is the slope");
  in.require(rules != SD_VANS_YADE || mesh_file.empty(),
             "keyword mesh: rules yade knows slices of one height only");
  in.require(!in.given("renewal") || eddies, "keyword renewal: there are no fluctuations");
  in.require(!eddies || couple != FLUID, "keyword fluctuation: couple fluid has no grains");
  const bool stands = g[0] == 0.0 && !dpdx.is_variable() && dpdx.number() == 0.0 && !driven &&
      profile_file.empty();
  in.require(!solves() || rest || !stands,
             "nothing drives the stream: give gravity an x component (the slope), "
             "pressure_gradient, surface speed or a profile, or stream rest");
}

void VansSettings::read_mesh()
{
  if (mesh_file.empty()) return;
  const std::string what = keyword("mesh") + ": file '" + mesh_file + "'";
  edge = read_list(lmp, keyword("mesh"), mesh_file, 0, "");
  if (edge.size() < 3)
    fail(lmp, what + " has " + std::to_string(edge.size()) + " edges, at least 3 are needed");
  z_ref = edge[0];
  for (size_t k = 0; k < edge.size(); k++) {
    edge[k] -= z_ref;
    if (k > 0 && !(edge[k] > edge[k - 1]))
      fail(lmp,
           what + ": edge " + std::to_string(k + 1) + " (" + text(edge[k] + z_ref) +
               ") is not above the one before");
  }
}

void VansSettings::read_given()
{
  const size_t N = ncell();
  if (given_file.empty()) {
    if (couple == FLUID) given.assign(3, std::vector<double>(N, 0.0));
    return;
  }
  const std::string what = keyword("given") + ": file '" + given_file + "'";
  const auto rows = read_rows(lmp, keyword("given"), given_file);
  const size_t columns = 3 + 2 * class_radii.size();
  if (rows.size() != N)
    fail(lmp,
         what + " has " + std::to_string(rows.size()) + " rows, ncell = " + std::to_string(N) +
             " are needed");
  given.assign(columns, std::vector<double>(N));
  for (size_t n = 0; n < N; n++) {
    if (rows[n].size() != columns && rows[n].size() != 3)
      fail(lmp,
           what + ", row " + std::to_string(n + 1) + " has " + std::to_string(rows[n].size()) +
               " values; phi, velocity and drag" +
               (columns > 3 ? ", then phi and drag of each of class_radii," : "") + " are needed");
    if (rows[n].size() < given.size()) given.resize(3);
    for (size_t c = 0; c < given.size(); c++) given[c][n] = rows[n][c];
    if (!(rows[n][0] >= 0.0 && rows[n][0] < 1.0))
      fail(lmp,
           what + ": phi = " + text(rows[n][0]) + " in slice " + std::to_string(n + 1) +
               ", it must be in [0, 1)");
  }
}

void VansSettings::parse(LAMMPS *lammps, const std::vector<std::string> &args, size_t begin)
{
  lmp = lammps;
  Keywords in(lmp, COMMAND, args, begin);
  read(in);
  check(in);
  if (rules == SD_VANS_YADE || couple != TWO) conserve = false;
  read_mesh();
  read_given();
  if (!profile_file.empty()) profile = read_profile(lmp, keyword("profile"), profile_file, ncell());
  if (!convective_file.empty())
    convective = read_list(lmp, keyword("convective"), convective_file, ncell(), "ncell");
  if (period > 0.0 && !(period / dt * ncell() <= MOST_WORK))
    fail(lmp,
         keyword("solve") + ": the step " + text(dt) + " is too short for the period " +
             text(period) + ": " + text(period / dt) + " steps of " + std::to_string(ncell()) +
             " slices in every coupling, most of a minute");
}

}    // namespace StokesDyn
