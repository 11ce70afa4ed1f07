/// @file
/// Room `ros/replay`, private: many replays in one process. Lines of arguments in, results and one answer a line out.
#pragma once

#include <istream>
#include <ostream>
#include <string>

namespace tissue_contact {

/// Each line of `in` is the arguments of one replay, with tabs between them. When it is over its answer goes to `out`, at once:
/// "ok<tab>CPU seconds", "failed<tab>CPU seconds<tab>what is wrong", or "broken" likewise where disk or memory did not suffice, so that
/// another try may go well. One that fails does not end the others.
/// @throws std::invalid_argument for a line that is too long; Interrupted.
void replayBatch(std::istream& in, std::ostream& out);

/// The same from a file, or from standard input where it is "-", to standard output.
/// @throws as replayBatch(), and when the file cannot be read.
void replayBatch(const std::string& file);

}  // namespace tissue_contact
