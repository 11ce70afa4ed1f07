/// @file
/// Executable tissue_contact_replay: see ros/replay/replay.h.
#include <csignal>

#include "ros/replay/replay.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is then an error of write(), which has a message
  return tissue_contact::runReplay(argc, argv);
}
