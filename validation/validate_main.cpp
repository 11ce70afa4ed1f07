/// @file
/// Executable tissue_contact_validate: see validation/validate.h.
#include <unistd.h>

#include <csignal>
#include <iostream>

#include "validation/validate.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is then an error of write(), which has a message
  return tissue_contact::runValidate(std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr,
                                     isatty(STDERR_FILENO) == 1);
}
