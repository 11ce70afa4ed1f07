/// @file
/// Bags: the joint states of two topics of a recording, as replay reads them.
#include <stdexcept>

#include "fuzz/fuzz_support.h"
#include "ros/bag/joint_state_bag.h"

using namespace tissue_contact;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::InputFile file;
  const std::string& path = file.hold("input.bag", fuzz::textOf(data, size));
  try {
    const JointStateBag bag(path, {"/probe/joint_states", "jaw"});
    fuzz::require(bag.missingTopics().size() < 2, "a bag that is accepted has a topic");
    std::size_t numbers = 0;
    bag.forEach([&](int topic, const JointStateSample& sample, const ros::Time&) {
      fuzz::require(topic == 0 || topic == 1, "topics that were asked for");
      numbers += sample.positions.size();
      for (const std::string& name : sample.names) numbers += name.size() / sizeof(double);
    });
    fuzz::require(numbers <= 1000000, "no more data than a small file can hold");
  } catch (const std::runtime_error& error) {
    fuzz::require(std::string(error.what()).find(path) != std::string::npos, "a refusal names the file");
  }
  return 0;
}
