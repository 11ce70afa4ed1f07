/// Prints the memory a scene takes: bytes per node and per contact, measured on the heap (glibc's mallinfo2), and how many
/// of those per contact are there for friction. Press-and-drag, both relaxations.
/// usage: memory
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "simulation/contact_memory.h"
#include "support/text_scene.h"

namespace {

using namespace tissue_contact;

/// What a contact stores that a frictionless one would not need.
constexpr std::size_t kFrictionBytes = sizeof(CoulombLaw) + sizeof(bool)  // law and history in the row
                                       + 2 * sizeof(double)               // tangential velocity of the tool
                                       + 2 * sizeof(double)               // tangential impulse
                                       + 8 * sizeof(double)               // W but for its normal entry
                                       + sizeof(unsigned char)            // changes of state
                                       + sizeof(Vector3)                  // slip kept for the next step
                                       + 2 * sizeof(ContactState);        // state in the solution and kept
static_assert(kFrictionBytes <= 256, "friction may take 256 bytes per contact");

#if __GLIBC_PREREQ(2, 33)
std::size_t heapBytes() { return mallinfo2().uordblks + mallinfo2().hblkhd; }
#else  // Ubuntu 20.04; up to 2 GiB
std::size_t heapBytes() { return static_cast<std::size_t>(mallinfo().uordblks) + mallinfo().hblkhd; }
#endif

std::string sceneText(int cells, const char* relaxation) {
  const std::string across = std::to_string(cells);
  return "gravity_m_per_s2: [0, 0, -0.1]\n" +
         blockScene("[0.10, 0.10, 0.04]", "[" + across + ", " + across + ", " + std::to_string(2 * cells / 5) + "]",
                    "poissons_ratio: 0.45") +
         "instruments:\n  - name: plate\n    urdf: package://tissue_contact/urdf/probe.urdf\n    tip_link: tip\n"
         "    joint_state_topics: [/probe/joint_states]\n    base_pose: {position_m: [-0.01, 0, 0.0801]}\n"
         "    contact_links: [{link: tip, shapes: [{sphere: {radius_m: 0.04}}]}]\n"
         "friction:\n  - {instrument: plate, tissue: block, static: 0.6, kinetic: 0.4}\n"
         "solver: {relaxation: " +
         relaxation + "}\n";
}

void measure(int cells, const char* relaxation) {
  const std::size_t before = heapBytes();
  auto simulator = std::make_unique<Simulator>(makeSimulator(sceneText(cells, relaxation)));
  simulator->advance(0.001, {Vector3(0.0, 0.0, 0.0)});  // one step under gravity: all per-node buffers are there
  const double nodes = simulator->tissues()[0].nodeCount();
  const std::size_t at_rest = heapBytes();
  for (int k = 1; k <= 300; ++k) simulator->advance(0.001, {Vector3(0.0, 0.0, -0.00002 * std::min(k, 250))});
  const auto contacts = static_cast<double>(simulator->contacts().size());
  const std::size_t touching = heapBytes();
  std::printf("%-13s %6.0f nodes %7.0f bytes/node   %4.0f contacts %7.0f bytes/contact, of which friction %zu\n",
              relaxation, nodes, static_cast<double>(at_rest - before) / nodes, contacts,
              static_cast<double>(touching - at_rest) / contacts, kFrictionBytes);
}

}  // namespace

int main() {
  for (const int cells : {10, 20}) {
    for (const char* relaxation : {"gauss_seidel", "cholesky"}) measure(cells, relaxation);
  }
  return 0;
}
