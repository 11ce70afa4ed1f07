#include "ros/bag/bag_reader.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "ros/bag/bag_merge.h"
#include "ros/bag/bag_records.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::string_view kVersionLine = "#ROSBAG V2.0\n";
constexpr std::string_view kAnyVersion = "#ROSBAG V";

/// A connection's data hold the whole definition of its message type; those of ROS have some ten kilobytes at most.
constexpr std::uint32_t kMaxDefinition = 1 << 22;

/// Of a topic's name, a type's or its md5sum: ROS's own have some dozens of bytes.
constexpr std::size_t kMaxName = 1024;

std::string nameFrom(const BagFields& fields, std::string_view field) {
  const std::string_view name = fields.text(field);
  if (name.size() > kMaxName) {
    throw BagError("the " + std::string(field) + " of a connection has " + std::to_string(name.size()) +
                       " bytes; at most " + std::to_string(kMaxName) + " are read",
                   BagError::Remedy::kAsSaid);
  }
  return std::string(name);
}

std::string remedyText(BagError::Remedy remedy) {
  switch (remedy) {
    case BagError::Remedy::kCopyAgain:
      return "; the file is damaged: copy it again from where it was recorded";
    case BagError::Remedy::kReindex:
      return "; `rosbag reindex` may mend it";
    case BagError::Remedy::kAsSaid:
      break;
  }
  return "";
}

BagError tooMany(std::uint64_t limit, const std::string& what) {
  return BagError("it has more than " + std::to_string(limit) + " " + what + ", which is more than is read",
                  BagError::Remedy::kAsSaid);
}

Compression compressionOf(std::string_view name) {
  if (name == "none") return Compression::kNone;
  if (name == "bz2") return Compression::kBz2;
  if (name == "lz4") return Compression::kLz4;
  throw BagError("a chunk is compressed by '" + printable(std::string(name), 32) + "'; known are none, bz2 and lz4",
                 BagError::Remedy::kAsSaid);
}

void requireVersion(const InputFile& input) {
  std::string line(std::min<std::uint64_t>(kVersionLine.size(), input.size()), '\0');
  input.read(0, line.data(), line.size());
  if (line == kVersionLine) return;
  if (std::string_view(line).substr(0, kAnyVersion.size()) == kAnyVersion) {
    throw BagError("format " + printable(line.substr(kAnyVersion.size(), 3)) +
                       "; only 2.0 is read, into which `rosbag filter old.bag new.bag True` turns it",
                   BagError::Remedy::kAsSaid);
  }
  throw BagError("this is no ROS bag: its first line is not '#ROSBAG V2.0'", BagError::Remedy::kAsSaid);
}

}  // namespace

ros::Time bagTime(std::uint64_t bits) {
  const auto seconds = static_cast<std::uint32_t>(bits & 0xffffffffU);
  const auto nanoseconds = static_cast<std::uint32_t>(bits >> 32U);
  if (nanoseconds >= 1000000000U) {
    throw BagError("a time of recording of " + std::to_string(seconds) + " s and " + std::to_string(nanoseconds) +
                   " ns; there are at most 999999999 ns");
  }
  ros::Time time;
  time.sec = seconds;
  time.nsec = nanoseconds;
  return time;
}

template <typename Work>
auto BagReader::guarded(const Work& work) const {
  try {
    return work();
  } catch (const BagError& error) {
    fail(error.what() + remedyText(error.remedy()));
  }
}

void BagReader::fail(const std::string& what) const { throw std::runtime_error("bag '" + file_ + "': " + what); }

void BagReader::fail(const BagMessage& message, const BagError& error) const {
  fail("message on " + printable(message.connection.topic) + " recorded at " +
       std::to_string(message.recorded.toSec()) + " s: " + error.what() + remedyText(error.remedy()));
}

std::string globalName(const std::string& topic) { return !topic.empty() && topic[0] == '/' ? topic : "/" + topic; }

BagReader::BagReader(const std::string& file, const BagLimits& limits) : file_(file), limits_(limits), input_(file) {
  guarded([this] {
    requireVersion(input_);
    readHeader();
    readConnections();
  });
}

void BagReader::readHeader() {
  const std::uint64_t start = kVersionLine.size();
  BagRecords records(openBytes(input_, start, input_.size() - start, Compression::kNone), start, input_.size());
  if (records.next() != Op::kFileHeader) throw BagError("its first record is not a bag's header");
  if (records.fields().has("encryptor") && !records.fields().text("encryptor").empty()) {
    throw BagError("it is encrypted; `rosbag decrypt` writes one that is not", BagError::Remedy::kAsSaid);
  }
  index_position_ = records.fields().number<std::uint64_t>("index_pos");
  chunk_count_ = records.fields().number<std::uint32_t>("chunk_count");
  connection_count_ = records.fields().number<std::uint32_t>("conn_count");
  records.skipData();
  records_position_ = records.position();
  if (index_position_ == 0) {
    throw BagError("it has no index, so recording has not ended or was cut off; " + wholePart(),
                   BagError::Remedy::kAsSaid);
  }
  if (index_position_ < records_position_ || index_position_ > input_.size()) {
    throw BagError("its index should be at byte " + std::to_string(index_position_) + ", but it has " +
                       std::to_string(input_.size()) + " bytes: it is cut off; " + wholePart(),
                   BagError::Remedy::kAsSaid);
  }
}

/// What there is of a bag without an index, in words, and how to get at it.
std::string BagReader::wholePart() const {
  const std::uint64_t start = records_position_;
  BagRecords records(openBytes(input_, start, input_.size() - start, Compression::kNone), start, input_.size());
  std::uint32_t chunks = 0;
  ros::Time last;
  try {
    while (!records.done()) {
      const Op op = records.next();
      const std::uint32_t count = op == Op::kIndex ? records.fields().number<std::uint32_t>("count") : 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        last = std::max(last, bagTime(records.readNumber<std::uint64_t>()));
        records.readNumber<std::uint32_t>();
      }
      records.skipData();
      chunks += static_cast<std::uint32_t>(op == Op::kChunk);
    }
  } catch (const BagError& end) {  // of the file, or of what is sound in it
    static_cast<void>(end);
  }
  if (chunks == 0) return "not one chunk of it is whole, so nothing can be recovered";
  std::ostringstream text;
  text << chunks << " whole chunks, recorded until " << last << " s, can be recovered: `rosbag reindex`";
  return text.str();
}

/// What stands behind the last chunk: connections, then a summary of each chunk.
void BagReader::readConnections() {
  BagRecords records(openBytes(input_, index_position_, input_.size() - index_position_, Compression::kNone),
                     index_position_, input_.size());
  std::uint32_t connections = 0;
  std::uint32_t chunks = 0;
  try {
    while (!records.done()) {
      const Op op = records.next();
      if (op != Op::kConnection && op != Op::kChunkInfo) throw BagError("it holds a record of another kind");
      if (op == Op::kConnection) {
        readConnection(records);
        ++connections;
      } else {
        readSummary(records);
        ++chunks;
      }
    }
    if (connections != connection_count_ || chunks != chunk_count_) {
      throw BagError("it lists " + std::to_string(connections) + " connections and " + std::to_string(chunks) +
                     " chunks, but the bag's header says " + std::to_string(connection_count_) + " and " +
                     std::to_string(chunk_count_));
    }
  } catch (const BagError& error) {
    if (error.remedy() == BagError::Remedy::kAsSaid) throw;
    throw BagError("its index is cut off or damaged: " + std::string(error.what()), BagError::Remedy::kReindex);
  }
}

/// How many messages of each connection there are, lest an index record that is lost go unnoticed.
void BagReader::readSummary(BagRecords& records) {
  const auto count = records.fields().number<std::uint32_t>("count");
  if (records.dataSize() != 8ULL * count) throw BagError("the length of a chunk's summary does not fit its count");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto number = records.readNumber<std::uint32_t>();
    const auto connection = connections_.find(number);
    if (connection == connections_.end()) {
      throw BagError("a chunk is said to hold connection " + std::to_string(number) + ", which is not listed");
    }
    summed_[number] += records.readNumber<std::uint32_t>();
  }
}

void BagReader::readConnection(BagRecords& records) {
  const auto number = records.fields().number<std::uint32_t>("conn");
  BagConnection connection;
  connection.topic = nameFrom(records.fields(), "topic");
  BagFields fields;
  fields.parse(records.data(kMaxDefinition));
  connection.type = nameFrom(fields, "type");
  connection.md5sum = nameFrom(fields, "md5sum");
  connections_.emplace(number, std::move(connection));  // of two with one number the first, as rosbag does
  if (connections_.size() > limits_.connections) throw tooMany(limits_.connections, "connections");
}

void BagReader::select(const std::function<bool(const BagConnection&)>& wanted) {
  counts_.clear();
  indexed_.clear();
  for (const auto& [number, connection] : connections_) {
    if (wanted(connection)) counts_[number] = indexed_[number] = 0;
  }
  chunks_.clear();
  parts_.clear();
  last_chunk_.clear();
  begin_ = end_ = ros::Time();
  guarded([this] { readIndex(); });
}

/// Chunks are passed over; each is followed by one index record for every connection that it has messages of.
void BagReader::readIndex() {
  BagRecords records(openBytes(input_, records_position_, index_position_ - records_position_, Compression::kNone),
                     records_position_, index_position_);
  while (!records.done()) {
    const Op op = records.next();
    if (op == Op::kChunk) {
      readChunk(records);
    } else if (op == Op::kIndex) {
      readChunkIndex(records);
    } else if (op != Op::kZeros) {  // `rosbag reindex` of ROS Melodic leaves them where a chunk was cut off
      throw BagError("the record that ends at byte " + std::to_string(records.dataPosition() + records.dataSize()) +
                     " is neither a chunk nor an index");
    }
  }
  if (chunks_.size() != chunk_count_) {
    throw BagError(
        "it has " + std::to_string(chunks_.size()) + " chunks, but its header says " + std::to_string(chunk_count_),
        BagError::Remedy::kReindex);
  }
  for (const auto& [number, indexed] : indexed_) {
    if (indexed == summed_[number]) continue;
    throw BagError("its chunks have an index of " + std::to_string(indexed) + " messages on " +
                       printable(connections_.at(number).topic) + ", but should have " +
                       std::to_string(summed_[number]),
                   BagError::Remedy::kReindex);
  }
  if (end_.sec - begin_.sec > static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max() - 1)) {
    throw BagError("it was recorded from " + std::to_string(begin_.sec) + " s to " + std::to_string(end_.sec) +
                       " s; at most 68 years can be played",
                   BagError::Remedy::kAsSaid);
  }
}

void BagReader::readChunk(BagRecords& records) {
  if (chunks_.size() == limits_.chunks) throw tooMany(limits_.chunks, "chunks");
  Chunk chunk;
  chunk.position = records.dataPosition();
  chunk.stored = records.dataSize();
  chunk.size = records.fields().number<std::uint32_t>("size");
  chunk.part = static_cast<std::uint32_t>(parts_.size());
  chunk.compression = compressionOf(records.fields().text("compression"));
  if (chunk.compression == Compression::kNone && chunk.size != chunk.stored) {
    throw BagError("the chunk at byte " + std::to_string(chunk.position) + " has " + std::to_string(chunk.stored) +
                   " bytes, but its header says " + std::to_string(chunk.size));
  }
  chunks_.push_back(chunk);
}

void BagReader::readChunkIndex(BagRecords& records) {
  try {
    if (chunks_.empty()) throw BagError("it belongs to no chunk");
    if (records.fields().number<std::uint32_t>("ver") != 1) throw BagError("its version is unknown");
    Part part;
    part.connection = records.fields().number<std::uint32_t>("conn");
    part.chunk = static_cast<std::uint32_t>(chunks_.size() - 1);
    if (connections_.count(part.connection) == 0) throw BagError("its connection is not listed");
    if (counts_.count(part.connection) == 0) return;
    const auto last = last_chunk_.find(part.connection);
    if (last != last_chunk_.end() && last->second == part.chunk) {
      throw BagError("it is its chunk's second of one connection");
    }
    readPart(records, part);
    if (part.count == 0) return;
    if (parts_.size() == limits_.parts) throw tooMany(limits_.parts, "chunks for the connections that are read");
    counts_[part.connection] += part.count;
    parts_.push_back(part);
    last_chunk_[part.connection] = part.chunk;
  } catch (const BagError& error) {
    const bool said = error.remedy() == BagError::Remedy::kAsSaid;
    throw BagError("index at byte " + std::to_string(records.dataPosition()) + ": " + error.what(),
                   said ? BagError::Remedy::kAsSaid : BagError::Remedy::kReindex);
  }
}

/// Only how many messages there are and when the first was recorded: where they lie is seen when the chunk is read.
void BagReader::readPart(BagRecords& records, Part& part) {
  const auto count = records.fields().number<std::uint32_t>("count");
  if (records.dataSize() != 12ULL * count) throw BagError("its length does not fit its count of messages");
  indexed_[part.connection] += count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const ros::Time time = bagTime(records.readNumber<std::uint64_t>());
    if (records.readNumber<std::uint32_t>() >= chunks_.back().size) throw BagError("it points beyond its chunk");
    if (time.isZero()) continue;  // rosbag::View leaves it out, too: its queries begin at 1 ns
    if (part.count++ == 0 || time < part.first) part.first = time;
    if (begin_.isZero() || time < begin_) begin_ = time;
    if (time > end_) end_ = time;
  }
}

std::uint64_t BagReader::messageCount(std::uint32_t connection) const {
  const auto found = counts_.find(connection);
  return found == counts_.end() ? 0 : found->second;
}

void BagReader::forEach(const std::function<bool(const BagMessage&)>& take) const {
  const auto merge = guarded([this] { return std::make_unique<BagMerge>(*this); });
  while (const auto message = guarded([&] { return merge->next(); })) {
    if (!take(*message)) return;
  }
}

}  // namespace tissue_contact
