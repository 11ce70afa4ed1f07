/// @file
/// Executable tissue_contact_place: see ros/place/place.h.
#include <csignal>

#include "ros/place/place.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is then an error of write(), which has a message
  return tissue_contact::runPlace(argc, argv);
}
