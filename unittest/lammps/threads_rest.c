/* For LD_PRELOAD (host.py), with Open MPI: MPI_Init returns when all other threads of the process rest.
 *
 * PMIx tells a thread of Open MPI 4.1 in MPI_Init which programming model has been declared, and MPI_Finalize unmaps
 * the code that takes this message without waiting for it. Where other programs have the cores, a run of a tenth of a
 * second is over before that thread had one: then it ends by signal 11, at an address that is not mapped. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* proc(5): the state follows the name of the thread, which is in brackets */
static int has_work(const char *thread)
{
  char path[64], line[512] = "";
  snprintf(path, sizeof path, "/proc/self/task/%.20s/stat", thread);
  FILE *file = fopen(path, "r");
  if (!file) return 0;
  const char *behind = fgets(line, sizeof line, file) ? strrchr(line, ')') : NULL;
  fclose(file);
  return behind && strlen(behind) > 2 && behind[2] == 'R';
}

static int others_have_work(void)
{
  DIR *threads = opendir("/proc/self/task");
  int found = 0;
  for (struct dirent *each; threads && (each = readdir(threads));)
    if (each->d_name[0] != '.' && atoi(each->d_name) != gettid()) found |= has_work(each->d_name);
  if (threads) closedir(threads);
  return found;
}

static int then_rest(int status)
{
  for (int tries = 0; tries < 10000 && others_have_work(); tries++) usleep(1000);
  return status;
}

int MPI_Init(int *argc, char ***argv)
{
  int (*init)(int *, char ***) = (int (*)(int *, char ***)) dlsym(RTLD_NEXT, "MPI_Init");
  return then_rest(init(argc, argv));
}

int MPI_Init_thread(int *argc, char ***argv, int asked, int *given)
{
  int (*init)(int *, char ***, int, int *) =
      (int (*)(int *, char ***, int, int *)) dlsym(RTLD_NEXT, "MPI_Init_thread");
  return then_rest(init(argc, argv, asked, given));
}
