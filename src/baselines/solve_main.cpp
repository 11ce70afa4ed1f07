/// @file
/// Executable tissue_contact_solve: see baselines/solve.h.
#include <csignal>
#include <iostream>

#include "baselines/solve.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is then an error of write(), which has a message
  return tissue_contact::runSolve(std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr);
}
