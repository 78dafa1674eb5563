#include "restart_words.h"

#include "keywords.h"

#include "comm.h"
#include "utils.h"

using namespace LAMMPS_NS;

namespace StokesDyn {

// 2: words alone. 3: the plugin's version before them, whatever else a later format may have.
static const int FORMAT = 3, WITHOUT_VERSION = 2;

void write_words(FILE *fp, const std::vector<std::string> &words)
{
  std::string all = SD_VERSION "\n";
  for (const auto &word : words) all += word + '\n';
  const int head[2] = {FORMAT, (int) all.size()};
  fwrite(head, sizeof(int), 2, fp);
  fwrite(all.data(), 1, all.size(), fp);
}

std::vector<std::string> read_words(LAMMPS *lmp, FILE *fp, const std::string &command)
{
  const bool root = lmp->comm->me == 0;
  int head[2] = {0, 0};
  if (root) utils::sfread(FLERR, head, sizeof(int), 2, fp, nullptr, lmp->error);
  MPI_Bcast(head, 2, MPI_INT, 0, lmp->world);
  if (head[0] < WITHOUT_VERSION || head[1] < 0)
    fail(lmp,
         command + ": the restart file was written by another version of the plugin (format " +
             std::to_string(head[0]) + ", this is version " SD_VERSION ", which reads " +
             std::to_string(FORMAT) +
             "); let that version read it and write a data file (write_data)");
  std::string all(head[1], '\0');
  if (root && !all.empty())
    utils::sfread(FLERR, &all[0], 1, all.size(), fp, nullptr, lmp->error);
  MPI_Bcast(&all[0], head[1], MPI_CHAR, 0, lmp->world);

  std::vector<std::string> words;
  for (size_t from = 0, to; (to = all.find('\n', from)) != std::string::npos; from = to + 1)
    words.push_back(all.substr(from, to - from));
  if (head[0] == WITHOUT_VERSION) return words;
  const std::string version = words.empty() ? "" : words.front();
  if (head[0] != FORMAT)
    fail(lmp,
         command + ": the restart file was written by another version of the plugin, " + version +
             ", in format " + std::to_string(head[0]) + "; this is version " SD_VERSION ", which reads " +
             std::to_string(FORMAT) +
             "; let that version read it and write a data file (write_data)");
  words.erase(words.begin());
  return words;
}

}    // namespace StokesDyn
