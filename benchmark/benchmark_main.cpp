/// @file
/// Executable tissue_contact_benchmark: see benchmark/benchmark.h.
#include <unistd.h>

#include <csignal>
#include <iostream>

#include "benchmark/benchmark.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is then an error of write(), which has a message
  return tissue_contact::runBenchmark(std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr,
                                      isatty(STDERR_FILENO) == 1);
}
