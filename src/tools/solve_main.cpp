/// @file
/// Executable tissue_contact_solve: see tools/solve.h.
#include <iostream>

#include "tools/solve.h"

int main(int argc, char** argv) {
  return tissue_contact::runSolve(std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr);
}
