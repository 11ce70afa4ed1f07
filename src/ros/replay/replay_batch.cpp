#include "ros/replay/replay_batch.h"

#include <ctime>
#include <fstream>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ros/replay/interruption.h"
#include "ros/replay/replay.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMaxLineBytes = std::size_t{8} << 20U;  // a thousand settings of the longest kind
constexpr std::size_t kShownBytes = 4000;

/// Of this process, s.
double cpuTime() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<std::string> argumentsOf(const std::string& line) {
  std::vector<std::string> arguments;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find('\t', begin), line.size());
    arguments.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return arguments;
}

/// @return the words of the answer before and behind the time.
std::pair<std::string, std::string> outcomeOf(const std::vector<std::string>& arguments) {
  try {
    const ReplayOptions options = parseReplayOptions(arguments);
    if (options.help || !options.batch_file.empty()) throw std::invalid_argument("a line of a batch is one replay");
    replay(options);
    return {"ok", ""};
  } catch (const Interrupted&) {
    throw;
  } catch (const WriteError& error) {
    return {"broken", "\t" + printable(error.what(), kShownBytes)};
  } catch (const std::bad_alloc&) {
    return {"broken", "\tmemory does not suffice"};
  } catch (const std::exception& error) {
    return {"failed", "\t" + printable(error.what(), kShownBytes)};
  }
}

}  // namespace

void replayBatch(std::istream& in, std::ostream& out) {
  std::vector<char> line(kMaxLineBytes);
  while (in.getline(line.data(), static_cast<std::streamsize>(line.size()))) {
    const double start = cpuTime();
    const auto [outcome, problem] = outcomeOf(argumentsOf(line.data()));
    out << outcome << '\t' << cpuTime() - start << problem << '\n';
    requireWritten(out);
  }
  if (!in.eof()) {
    throw std::invalid_argument("a line of the batch has more than " + std::to_string(kMaxLineBytes) + " bytes");
  }
}

void replayBatch(const std::string& file) {
  if (file == "-") return replayBatch(std::cin, std::cout);
  requireRegularFile(file, "batch");
  std::ifstream in(file);
  replayBatch(in, std::cout);
}

}  // namespace tissue_contact
